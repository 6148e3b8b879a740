"""What is installed is the program alone."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("package", ["calib", "drivers", "service"])
def test_no_test_file_lies_in_a_package_that_is_installed(package: str) -> None:
    modules = [path.name for path in (ROOT / package).rglob("*.py")]
    assert len(modules) > 10
    assert [name for name in modules if name == "conftest.py" or name.startswith("test_")] == []
