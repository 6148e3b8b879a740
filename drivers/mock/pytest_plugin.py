"""A pytest plugin: the fixture `darkflat_bench`, a mocked bench for anybody's tests.

Every pytest run of an environment that has darkflat loads this file; it therefore imports nothing
heavy until a test asks for the fixture.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from drivers.mock.mocked_bench import MockedBench


@pytest.fixture
def darkflat_bench(tmp_path: Path) -> "Iterator[MockedBench]":
    """Camera, light, monitor and shutter without any transport; dark and uncapped at first.

    The camera is that of the preset `demo`: 1,024 columns, 12 bits, a sphere of 6 lamps.
    """
    from drivers.mock.mocked_bench import mocked_bench  # noqa: PLC0415 (see above)

    with mocked_bench(tmp_path) as bench:
        yield bench
