"""8-bit cameras whose noise is below a code: rounding is undone, or said not to be."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.recording.block_statistics import BlockStatistics
from calib.recording.header import Block, CameraHeader
from calib.transfer.photon_transfer.dark_level import dark_level
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.noise_line import NoiseLine
from calib.transfer.photon_transfer.recorded_cells import from_column_statistics
from calib.transfer.photon_transfer.rounding_state import Rounding
from calib.transfer.photon_transfer.unrounding import unrounded_cells
from calib.transfer.photon_transfer.variance_curve import rounded_variance
from tests.calib.transfer.photon_transfer.little_noise import EightBits
from tests.calib.transfer.photon_transfer.little_noise_coverage import (
    WAYS,
    by_columns,
    drawn,
    score,
    scores,
)
from tests.calib.transfer.photon_transfer.simulated import Held

SIGMAS = (0.17, 0.3, 0.5, 1.0)
EACH = 3
SMALL = EightBits(0.17, columns=192, lines=48)


def assert_covers(z: NDArray[np.float64], most_off: float) -> None:
    n = len(z)
    assert (np.abs(z.mean(axis=0)) < most_off + 4 / np.sqrt(n)).all()
    assert (np.abs(z.std(axis=0, ddof=1) - 1) < most_off + 4 / np.sqrt(2 * n)).all()


def test_errors_are_as_large_as_stated_whatever_the_noise() -> None:
    found: dict[str, list[list[float]]] = {way: [] for way in WAYS}
    for sigma in SIGMAS:
        camera = replace(SMALL, read_dn=sigma)
        for seed in range(EACH):
            held = drawn(camera, seed)
            for way, measure in WAYS.items():
                found[way].append(score(camera, measure(held)))
    for z in found.values():
        assert_covers(np.array(z), 0.1)


@pytest.mark.soak
@pytest.mark.parametrize("sigma", [*SIGMAS, 0.12, 0.22, 0.25, 0.28, 0.35])
@pytest.mark.parametrize("way", list(WAYS))
def test_errors_are_as_large_as_stated_over_many_recordings(way: str, sigma: float) -> None:
    # 1 ± 0.1 and 0 ± 0.1 are the promise, four standard errors of 400 recordings come on top.
    assert_covers(scores(EightBits(sigma), way, range(1000, 1400)), 0.1)


def test_the_answer_says_how_far_rounding_was_undone() -> None:
    of = {s: by_columns(drawn(replace(SMALL, read_dn=s), 1)) for s in (0.03, 0.17, 0.35, 1.0)}
    states = {s: found.taps[0].rounding for s, found in of.items()}
    assert states == {
        0.03: Rounding.HIDDEN,
        0.17: Rounding.ON_AVERAGE,
        0.35: Rounding.BY_CELL,
        1.0: Rounding.WHITE,
    }
    assert not of[0.03].read_noise_e.is_known
    assert "below 0.1 DN" in of[0.03].read_noise_dn.reason
    assert any("hides it" in w for w in of[0.03].warnings)
    assert any("undone on average" in w for w in of[0.17].warnings)
    assert not any("rounding" in w for s in (0.35, 1.0) for w in of[s].warnings)
    gain = of[0.03].system_gain
    assert abs(gain.value - SMALL.gain) < 4 * gain.std


@pytest.mark.parametrize("offset_dn", [6.0, 6.25, 6.4, 6.5])
def test_pixels_of_one_phase_do_no_harm_whichever_it_is(offset_dn: float) -> None:
    camera = replace(SMALL, read_dn=0.3, offset_dn=offset_dn, offset_std_dn=0.0)
    held = drawn(camera, 2)
    for measure in WAYS.values():
        assert (np.abs(score(camera, measure(held))) < 4).all()


def test_pixels_of_one_phase_that_is_not_known_make_the_noise_unsure() -> None:
    spread = by_columns(drawn(SMALL, 3))
    alike = by_columns(drawn(replace(SMALL, offset_dn=6.3, offset_std_dn=0.0), 3))
    assert alike.read_variance_dn2.std > 1.5 * spread.read_variance_dn2.std
    off = (alike.read_variance_dn2.value - SMALL.read_dn**2) / alike.read_variance_dn2.std
    assert abs(off) < 4


@pytest.mark.parametrize("wrong", [0.94, 1.06])
def test_what_is_undone_does_not_hang_on_the_noise_that_it_was_undone_with(wrong: float) -> None:
    sigma, n_lines, n = 0.28, 200, 40_000
    rng = np.random.default_rng()
    codes = np.rint(20.0 + rng.random(n) + sigma * rng.standard_normal((n_lines, n)))
    block = Block(block="0", kind="dark", exposure_us=1.0, level=0.0)
    none = np.zeros(n, np.int64)
    seen = BlockStatistics(
        block, n_lines, codes.mean(axis=0), codes.var(axis=0, ddof=1), none, none
    )
    recorded = from_column_statistics(CameraHeader(columns=n, bit_depth=8), [seen])
    line = NoiseLine(np.zeros(1), np.array([wrong * sigma**2]))
    level = dark_level(recorded.blocks, recorded.tap, recorded.pixels)
    done = unrounded_cells(recorded.blocks, level, line, tap=recorded.tap, pixels=recorded.pixels)
    assert not done.unknown.any()
    (undone,) = done.blocks
    truth = rounded_variance(np.array([sigma**2]))[0]
    shift = abs(rounded_variance(np.array([wrong * sigma**2]))[0] - truth)
    off = undone.variance_dn2.mean() - truth
    # Half of the shift would be left without the lever; its second order is left with it.
    assert abs(off) < 4 * undone.variance_dn2.std() / np.sqrt(n) + 0.15 * shift


@pytest.mark.parametrize("sigma", [0.17, 0.3])
def test_cells_that_pool_pixels_take_the_average_over_their_phases(sigma: float) -> None:
    of = {}
    for spread in (0.0, 1.0):
        camera = EightBits(
            sigma, columns=48 * 48, lines=8, offset_std_dn=spread, offset_dn=6.4, profile_low=0.95
        )
        found = photon_transfer(in_frames(drawn(camera, 4), 48))
        assert found.taps[0].rounding is Rounding.ON_AVERAGE
        assert (np.abs(score(camera, found)) < 4).all()
        of[spread] = found.read_variance_dn2.std
    # What the darks do not tell where all pixels have one phase, flats of some 40 DN do: K comes
    # from brighter ones, and their K·s is known to 1 %.
    assert of[0.0] > 2 * of[1.0]


def in_frames(held: Held, columns: int) -> Held:
    """The columns of a line sensor, folded into rows: frames of an area sensor."""
    frames = {
        name: tuple(dn.reshape(len(dn), -1, columns) for dn in stretches)
        for name, stretches in held.stretches.items()
    }
    rows = held.header.camera.columns // columns
    camera = CameraHeader(columns=columns, rows=rows, bit_depth=8)
    return Held(held.header.model_copy(update={"camera": camera}), frames)
