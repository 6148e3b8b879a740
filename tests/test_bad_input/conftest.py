from pathlib import Path

import pytest

from tests.test_bad_input.sound import make_sound_files


@pytest.fixture(scope="session")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of sound files (see `sound.py`), made once; to be copied, not to be changed."""
    folder = tmp_path_factory.mktemp("sound")
    make_sound_files(folder)
    return folder
