"""How many frames may wait for a consumer that a busy machine has put to sleep."""

from dataclasses import replace

import pytest

from drivers.aravis.frame_stream import buffers_for
from tests.contracts.simulated_camera import SETTINGS

PER_FRAME = {
    "a second of them": (64, 1000.0, 65_536, 16),  # 15.6 a second, but 16 in any case
    "many small ones": (64, 100.0, 65_536, 157),
    "as many large ones as 128 MB hold": (714, 14.0, 4_386_816, 30),
    "16 of the largest": (714, 14.0, 100_000_000, 16),
}


@pytest.mark.parametrize(
    ("lines", "period_us", "payload", "wanted"), PER_FRAME.values(), ids=PER_FRAME
)
def test_a_second_of_frames_may_wait_where_memory_allows(
    lines: int, period_us: float, payload: int, wanted: int
) -> None:
    settings = replace(SETTINGS, frame_lines=lines, line_period_us=period_us)
    assert buffers_for(settings, payload) == wanted
