"""Noise that a line, or all rows of a frame, share: neither flicker nor banding."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.random import Generator, default_rng
from scipy.signal import lfilter
from scipy.stats import chi2

from calib.arrays import Lines
from calib.diagnosis.answer.finding import Finding
from calib.diagnosis.diagnose import examine
from calib.diagnosis.evidence.evidence import Evidence
from calib.forward.conditions import Conditions
from calib.forward.effects.line_noise import LineNoise
from calib.forward.taps import tap_of_pixel
from tests.calib.diagnosis.recordings import plain_model, plan, recorded
from tests.calib.forward.small_sensors import at

STD_DN = 1.0


@dataclass(frozen=True)
class Wandering(LineNoise):
    """Line noise of which each line keeps 0.6 of the one before."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """DN in and out, (n_lines, n_columns)."""
        fresh = rng.standard_normal(len(signal) + 50)
        return np.asarray(signal + self.std_dn * lfilter([0.8], [1.0, -0.6], fresh)[50:, None])


def drawn() -> Evidence:
    rng = default_rng()
    effects = (LineNoise(STD_DN, "frame"),)
    return recorded(plain_model(32, rows=12), plan(rng, 40), rng, effects)


def test_an_offset_of_each_frame_is_named_line_noise_alone() -> None:
    # Of 25 such recordings two were left unexplained.
    right = two_of_three_named(drawn)
    for found in right:
        told = found.parameters["std_dn"]
        assert found.effect == LineNoise(told.value, "frame")
        assert abs(told.value - STD_DN) < 4.0 * told.std


def test_an_offset_of_each_tap_is_named_line_noise_and_no_drift_of_taps() -> None:
    effect = LineNoise(0.8, each_tap=True, tap_layout="halves")

    def of_taps() -> Evidence:
        rng = default_rng()
        model = plain_model(64, taps=2, layout="halves")
        return recorded(model, plan(rng, 40), rng, (effect,))

    for found in two_of_three_named(of_taps):
        told = found.parameters["std_dn"]
        assert found.effect == replace(effect, std_dn=told.value)
        assert abs(told.value - effect.std_dn) < 4.0 * told.std


def two_of_three_named(draw: Callable[[], Evidence]) -> list[Finding]:
    """Return what says line noise alone, of at most three recordings: a third one if one failed."""
    right: list[Finding] = []
    for tried in range(3):
        found = examine(draw()).diagnosis.findings
        right += [one for one in found if [f.effect.name for f in found] == ["line_noise"]]
        if len(right) == 2:
            break
        assert len(right) >= tried, found
    return right


def test_first_frames_scatter_as_the_mean_of_rows_that_move_together() -> None:
    evidence = drawn()
    seen = evidence.observed().onset[1:] / evidence.onset_std[1:]
    # Once in 10,000 runs by chance; were its rows taken for independent, 12 times too much.
    assert (seen**2).sum() < chi2.isf(1e-4, seen.size)
    assert (seen**2).sum() > chi2.ppf(1e-4, seen.size)


@pytest.mark.parametrize(("shared_by", "alike"), [("row", False), ("frame", True)])
def test_rows_of_a_frame_move_alike_or_each_alone(shared_by: str, alike: bool) -> None:
    moved = LineNoise(1.0, shared_by).apply(np.zeros((3, 4, 5)), at(3), default_rng())
    assert np.ptp(moved, axis=2).max() == 0.0
    assert bool(np.ptp(moved, axis=1).max() == 0.0) is alike
    assert np.ptp(moved, axis=0).min() > 0.0


@pytest.mark.parametrize(("layout", "sample"), [("quarters", (8,)), ("quadrants", (4, 6))])
def test_each_tap_moves_by_itself(layout: str, sample: tuple[int, ...]) -> None:
    effect = LineNoise(1.0, "frame", each_tap=True, tap_layout=layout)
    moved, tap = (
        effect.apply(np.zeros((3, *sample)), at(3), default_rng()),
        tap_of_pixel(layout, sample),
    )
    for t in range(4):
        assert np.ptp(moved[:, tap == t], axis=1).max() == 0.0
    assert len(np.unique(moved)) == 3 * 4


def test_lines_whose_offset_wanders_have_line_noise_and_no_tone() -> None:
    rng, n = default_rng(), 60

    def wandering() -> Evidence:
        return recorded(plain_model(64), plan(rng, n), rng, (Wandering(0.6),))

    assert len(two_of_three_named(wandering)) == 2
