"""Noise, selection and fit in turn: where they end does not depend on when they stop."""

from dataclasses import replace

import numpy as np
import pytest

from calib.radiometric.estimation import estimate
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.order_choice import FOLDS, compare_orders
from calib.radiometric.estimation.radiance_table import group_levels
from calib.radiometric.estimation.vignette import ORDERS, tap_contrasts
from calib.radiometric.estimation.whitened import whitened_rows
from tests.calib.radiometric.simulated import Bench, draw, smooth_profile

EIGHT_BITS = Bench(
    bit_depth=8, gain=0.004, read_dn=0.35, offset_mean=6.0, offset_std=1.2, response=0.1, lines=40
)


def lines_of(bench: Bench, *, pixels: bool) -> estimate.LineEstimate:
    statistics = draw(bench, np.random.default_rng(7), pixels=pixels).statistics
    flats = BlockTable.of_kind(statistics.fit, "flat")
    darks = BlockTable.of_kind(statistics.fit, "dark")
    full_scale = bench.header().camera.full_scale_dn
    return estimate.estimate_lines(flats, darks, group_levels(flats.blocks), full_scale)


@pytest.mark.parametrize(
    ("bench", "pixels"),
    [
        pytest.param(Bench(), False, id="12-bit"),
        pytest.param(EIGHT_BITS, True, id="8-bit"),
        pytest.param(replace(EIGHT_BITS, read_dn=0.17), True, id="8-bit-below-rounding"),
        pytest.param(Bench(dark_current=0.05, darks=5), False, id="dark-current"),
    ],
)
def test_more_rounds_change_nothing_that_counts(
    bench: Bench, pixels: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = lines_of(bench, pixels=pixels)
    monkeypatch.setattr(estimate, "ROUNDS", 12)
    monkeypatch.setattr(estimate, "NEAR_SHARE", 1e-9)
    settled = lines_of(bench, pixels=pixels)
    moved_dn = np.abs(found.fit.offset - settled.fit.offset)
    assert (moved_dn <= 1e-5 * np.sqrt(settled.fit.lines.offset_variance)).all()
    moved = np.abs(found.fit.slope - settled.fit.slope)
    assert (moved <= 1e-5 * np.sqrt(settled.fit.lines.slope_variance)).all()
    assert found.noise.is_near(settled.noise, 1e-3)


def test_one_basis_for_all_orders_predicts_as_a_fit_of_each_does() -> None:
    rng = np.random.default_rng(3)
    slope = smooth_profile(1024) * (1 + 0.02 * rng.standard_normal(1024))
    contrasts = tap_contrasts(np.arange(1024) % 2)
    x = np.linspace(-1, 1, 1024)
    design = np.hstack([contrasts, np.polynomial.legendre.legvander(x, ORDERS[-1])])
    use = np.ones(1024, np.bool_)
    state = whitened_rows(design, slope, np.full(1024, 1e-6), use, ORDERS[-1])
    choice = compare_orders(state, tuple(ORDERS), n_taps=1)
    fold = (np.arange(1024) // 8) % FOLDS
    for order, rms in zip(choice.orders, choice.held_out_rms, strict=True):
        missed, rows = 0.0, state.design[:, : order + 2]
        for f in range(FOLDS):
            seen = fold != f
            found = np.linalg.lstsq(rows[seen], state.target[seen], rcond=None)[0]
            missed += ((state.target - rows @ found)[~seen] ** 2).sum()
        typical = np.median(state.relative_sigma)
        assert rms == pytest.approx(typical * np.sqrt(missed / 1024), rel=1e-9)
        found, (rest,), *_ = np.linalg.lstsq(rows, state.target, rcond=None)
        residual = choice.residual_std[choice.orders.index(order)]
        assert residual == pytest.approx(typical * np.sqrt(rest / (1024 - order - 2)), rel=1e-9)
