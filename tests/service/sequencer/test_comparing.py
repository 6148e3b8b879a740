"""The comparison of two recordings sees what a resumed sweep could do wrong."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.forward.model import Model
from calib.recording.protocol import Recording
from service.cli.simulated_recording import simulate_recording
from tests.service.sequencer.comparing import CHANCE_SIGMA, compare
from tests.service.sequencer.sweep_plans import whole_sweep

DEMO = Model.preset("demo")
PLAN = whole_sweep(DEMO, (25.0, 50.0, 75.0, 100.0), (1, 2), columns=256, lines=64, frame_lines=64)


def drawn(model: Model, out: Path) -> Recording:
    return simulate_recording(model, PLAN, out, seed=None, scenes_folder=out.parent)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return drawn(DEMO, tmp_path_factory.mktemp("undisturbed") / "a.h5")


def other_pattern(model: Model) -> Model:
    return model.with_effect(replace(model.effect("responsivity"), prnu_seed=7))


def other_offsets(model: Model) -> Model:
    return model.with_effect(replace(model.effect("offset"), pattern_seed=7))


def raised_offset(model: Model) -> Model:
    offset = model.effect("offset")
    # Of 1 DN fourteen recordings made 4.4 to 15 standard deviations, of 4 DN 37 to 60: the unit is
    # what lamps scatter by, and few flats tell it.
    return model.with_effect(replace(offset, mean_dn=offset.mean_dn + 4.0))


def dimmer_lamps(model: Model) -> Model:
    lamps = model.effect("illumination")
    return model.with_effect(replace(lamps, radiance=tuple(0.98 * r for r in lamps.radiance)))


DIFFERENT: dict[str, tuple[Callable[[Model], Model], str]] = {
    "another pattern of responsivity": (other_pattern, "slope_spread"),
    "another pattern of offsets": (other_offsets, "offset_spread"),
    "all offsets higher": (raised_offset, "offset_common"),
    "all lamps dimmer": (dimmer_lamps, "slope_common"),
}


def test_two_recordings_of_one_bench_agree(undisturbed: Recording, tmp_path: Path):
    agreement = compare(undisturbed, drawn(DEMO, tmp_path / "b.h5"))
    agreement.check(light_percent=0.5)
    assert agreement.columns == 256


@pytest.mark.parametrize(("change", "seen_in"), DIFFERENT.values(), ids=DIFFERENT)
def test_what_differs_is_seen(undisturbed: Recording, tmp_path: Path, change, seen_in):
    agreement = compare(undisturbed, drawn(change(DEMO), tmp_path / "b.h5"))
    with pytest.raises(AssertionError):
        agreement.check(light_percent=50.0)
    chance = 1.5 if seen_in.endswith("spread") else CHANCE_SIGMA
    assert abs(getattr(agreement, seen_in)) > chance


def test_light_that_was_not_settled_in_one_block_is_seen(undisturbed: Recording, tmp_path: Path):
    lamps = DEMO.effect("illumination")
    dim = DEMO.with_effect(replace(lamps, radiance=(lamps.radiance[0], 0.97 * lamps.radiance[1])))
    agreement = compare(undisturbed, drawn(dim, tmp_path / "b.h5"))
    assert agreement.light_percent == pytest.approx(100 * 0.03 * 9.9 / 20.1, rel=0.3)
    assert np.isfinite(agreement.slope_common)
