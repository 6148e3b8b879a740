import pytest

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from calib.recording.header import Block
from service.sequencer.look_ahead import BRIGHTEST_KEY, predicted_dn
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, short_plan, whole_blocks

LIMIT_DN = 4000.0


def taken(kind, exposure_us, level, brightest_dn, **more):
    extra = {BRIGHTEST_KEY: brightest_dn}
    return Block(block="x", kind=kind, exposure_us=exposure_us, level=level, **more, **extra)


def coming(exposure_us, level, **more):
    return Block(block="y", kind="flat", exposure_us=exposure_us, level=level, **more)


DARK = taken("dark", 100.0, 0.0, 100.0)

PREDICTIONS = {
    "nothing is known": (coming(100, 1), [], None),
    "darks alone say nothing of light": (coming(100, 1), [DARK], None),
    "twice the exposure, on the dark's offset": (
        coming(200, 1),
        [DARK, taken("flat", 100, 1, 1100.0)],
        2100.0,
    ),
    "three times the lamps": (coming(100, 3), [DARK, taken("flat", 100, 1, 1100.0)], 3100.0),
    "the certificate goes before the number of lamps": (
        coming(100, 2, radiance=15.0),
        [DARK, taken("flat", 100, 1, 1100.0, radiance=10.0)],
        1600.0,
    ),
    "the same level goes before a later one": (
        coming(200, 1),
        [taken("flat", 100, 1, 1000.0), taken("flat", 100, 2, 2500.0)],
        2000.0,
    ),
    "a saturated block is no reference": (
        coming(100, 2),
        [taken("flat", 100, 1, 1500.0), taken("flat", 100, 3, 4095.0)],
        3000.0,
    ),
    "brighter than what saturated, saturates": (
        coming(300, 1),
        [taken("flat", 200, 1, 4095.0)],
        LIMIT_DN,
    ),
    "dimmer than what saturated, nobody knows": (
        coming(100, 1),
        [taken("flat", 200, 1, 4095.0)],
        None,
    ),
}


@pytest.mark.parametrize(("block", "before", "wanted"), PREDICTIONS.values(), ids=PREDICTIONS)
def test_the_brightest_column_is_predicted(block, before, wanted):
    expected = predicted_dn(block, before, limit_dn=LIMIT_DN)
    assert expected == (None if wanted is None else pytest.approx(wanted))


def bright_plan(action):
    """Return a plan whose third flat saturates by far on the demo's camera."""
    exposures = [50.0, 100.0, 950.0]
    return short_plan(
        sweep={"type": "exposure", "exposures_us": exposures, "level": 2},
        darks="before",
        saturation={"action": action},
    )


def test_a_block_that_would_saturate_is_taken_and_noted(bench, out):
    result = run_plan(bench, bright_plan("note"), out)
    assert (result.blocks_done, result.skipped) == (6, ())
    assert any(note.startswith("block 005 will saturate") for note in result.notes)
    full_scale = FileRecording(out).header.camera.full_scale_dn
    assert FileRecording(out).header.blocks[-1].model_extra[BRIGHTEST_KEY] == full_scale


def test_a_block_that_would_saturate_is_left_out(bench, out):
    result = run_plan(bench, bright_plan("skip"), out)
    assert (result.state, result.skipped) == ("succeeded", ("005",))
    assert "005" not in whole_blocks(out)


def test_a_block_that_was_left_out_stays_so_after_resuming(bench, out):
    run_plan(bench, bright_plan("skip"), out)
    resumed = run_plan(bench, bright_plan("skip"), out, resume=True)
    assert (resumed.frames, resumed.skipped) == (0, ("005",))


def test_a_run_stops_before_a_block_that_would_saturate(bench, out):
    with pytest.raises(DarkflatError, match="block 005 would saturate") as caught:
        run_plan(bench, bright_plan("stop"), out)
    assert caught.value.code == "saturation-ahead"
    assert set(whole_blocks(out)) == {"000", "001", "002", "003", "004"}
    assert_dark(bench.world)
