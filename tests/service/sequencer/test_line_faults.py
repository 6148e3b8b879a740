"""What goes wrong on a serial line in the middle of a run: each fault of docs/faults.md.

The controllers are emulators on pseudo-terminals, and the fault comes between two frames of the
second block: the run waits until the emulators have it. The block's conditions cannot be read back
then, so that it is not whole.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import pytest

from calib.errors import DarkflatError
from service.bench import Bench, open_bench
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, whole_blocks
from tests.service.sequencer.line_benches import GEN, line_plan, on_lines
from tests.service.sequencer.test_faults import at_frame

SWEEP = {"type": "exposure", "exposures_us": [50.0, 100.0], "level": 1}
FLATS = line_plan(sweep=SWEEP, darks="none")
WITH_DARK_LAST = line_plan(sweep=SWEEP, darks="after")


@pytest.fixture(scope="module")
def on_emulators() -> Iterator[Bench]:
    with open_bench(on_lines("faults", GEN, lamps=1)) as bench:
        yield bench


@pytest.fixture
def lines(on_emulators: Bench) -> Iterator[Bench]:
    """The bench; whatever a test did to it is mended after, so that the next one finds it sound."""
    yield on_emulators
    for mend in ("lamp 1 restore", "shutter stick off"):
        on_emulators.simulated.emulators.inject(mend)
    for line, mend in product(("lamps", "monitor", "shutter"), ("return", "mend")):
        on_emulators.simulated.emulators.inject(f"{line} {mend}")


@dataclass(frozen=True)
class Fault:
    """In the words of `drivers.mock.emulators.fault_commands`; what is said of it; its remedy."""

    inject: str
    code: str
    said: str
    mend: str = ""


DARK_AFTERWARDS = {
    "lamps garbled": Fault("lamps garble 1", "reply-garbled", "garbled reply"),
    "lamps late": Fault("lamps delay 1.5 1", "device-timeout", "no whole reply"),
    "lamp browns out": Fault(
        "lamp 1 brown-out", "lamp-out", "block 001, but level 0 reads back (lamp 1 is off)",
        "lamp 1 restore",
    ),
    "lamp burns out": Fault(
        "lamp 1 burn-out", "lamp-out", "(lamp 1 is at 0 A, not 4 A)", "lamp 1 restore"
    ),
    "monitor garbled": Fault("monitor garble 1", "reply-garbled", "monitor at"),
    "monitor late": Fault("monitor delay 2.0 1", "device-timeout", "monitor at"),
    "monitor unplugged": Fault(
        "monitor vanish", "device-lost", "plug it in again", "monitor return"
    ),
}  # fmt: skip


def fails(bench: Bench, out, plan, act, *, frame: int = 6) -> DarkflatError:
    """Run `plan`, let `act` happen, and return the one sentence in which it ended."""
    with pytest.raises(DarkflatError) as caught:
        run_plan(bench, plan, out, on_progress=at_frame(frame, act))
    assert "\n" not in str(caught.value)
    return caught.value


@pytest.mark.parametrize("fault", DARK_AFTERWARDS.values(), ids=DARK_AFTERWARDS)
def test_a_fault_ends_dark_in_one_sentence_and_the_run_goes_on_once_it_is_mended(lines, out, fault):
    emulators = lines.simulated.emulators
    error = fails(lines, out, FLATS, lambda: emulators.inject(fault.inject))
    assert error.code == fault.code
    assert fault.said in str(error)
    assert_dark(lines.world)
    assert whole_blocks(out) == {"000": 32}
    if fault.mend:
        emulators.inject(fault.mend)
    assert run_plan(lines, FLATS, out, resume=True).state == "succeeded"
    assert whole_blocks(out) == {"000": 32, "001": 32}


def test_light_beyond_the_monitors_range_is_an_error_and_no_reading(lines, out):
    error = fails(lines, out, FLATS, lambda: lines.world.drive(0, 50.0))
    assert error.code == "monitor-overflow"
    assert_dark(lines.world)
    assert whole_blocks(out) == {"000": 32}


STUCK_SHUTTERS = {
    "unplugged": Fault("shutter vanish", "device-lost", "shutter at", "shutter return"),
    "stuck": Fault("shutter stick on", "shutter-stuck", "relay 1", "shutter stick off"),
    "silent": Fault("shutter silent on", "device-timeout", "shutter at", "shutter mend"),
}


@pytest.mark.parametrize("fault", STUCK_SHUTTERS.values(), ids=STUCK_SHUTTERS)
def test_a_shutter_that_does_not_close_takes_no_dark(lines, out, fault):
    emulators = lines.simulated.emulators
    error = fails(lines, out, WITH_DARK_LAST, lambda: emulators.inject(fault.inject))
    emulators.inject(fault.mend)
    assert error.code == fault.code
    assert fault.said in str(error)
    assert_dark(lines.world)
    assert whole_blocks(out) == {"000": 32, "001": 32}


OUT_OF_REACH = {
    "unplugged": ("lamps vanish", "lamps return"),
    "deaf": ("lamps deaf on", "lamps mend"),
}


@pytest.mark.parametrize(("inject", "mend"), OUT_OF_REACH.values(), ids=OUT_OF_REACH)
def test_lamps_that_no_command_reaches_are_said_to_burn_and_go_off_once_they_can(
    lines, out, inject, mend
):
    emulators = lines.simulated.emulators
    error = fails(lines, out, FLATS, lambda: emulators.inject(inject))
    assert error.code == "lamps-not-off"
    assert "switch them off by hand" in str(error)
    assert lines.world.state().lamps[0].target > 0
    assert whole_blocks(out) == {"000": 32}
    emulators.inject(mend)
    lines.safe_off()
    assert_dark(lines.world)


def test_lamps_that_hear_but_do_not_answer_go_off_all_the_same(lines, out):
    emulators = lines.simulated.emulators
    error = fails(lines, out, FLATS, lambda: emulators.inject("lamps silent on"))
    assert error.code == "lamps-not-off"
    assert_dark(lines.world)


def test_a_port_that_another_program_holds_is_refused_by_name(lines):
    taken = on_lines("second", {**GEN, "port": lines.simulated.port("lamps")}, lamps=1)
    with pytest.raises(DarkflatError, match="lamps") as caught:
        open_bench(taken)
    assert caught.value.code == "device-busy"
