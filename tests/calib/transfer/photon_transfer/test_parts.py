"""Dark charge, overdispersion, turn-off: the parts that only some recordings need."""

from dataclasses import replace

import numpy as np
import pytest

from calib.recording.header import Block
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.dark_level import dark_level
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.overdispersion import deviance, excess
from calib.transfer.photon_transfer.variance_curve import MOST_EXPONENT, exponential_share
from tests.calib.transfer.photon_transfer.simulated import GAIN, READ_DN, recording


def darks(growth: float, rng: np.random.Generator, n_cells: int = 40) -> list[BlockCells]:
    """Eight darks of 100 lines at four exposures, σ = 3 DN, growing in DN per µs."""
    own = rng.uniform(90.0, 110.0, n_cells)
    nan, one = np.full(n_cells, np.nan), np.ones(n_cells)
    return [
        BlockCells(
            block=Block(block=f"{k}", kind="dark", exposure_us=t),
            n_exposures=100,
            mean_dn=own + growth * t + 0.3 * rng.standard_normal(n_cells),
            variance_dn2=9.0 * one,
            covariance_dn2=np.empty((0, n_cells)),
            lags=(),
            lag_share=np.empty(0),
            square_factor=0.02 * one,
            cumulant_factor=0.01 * one,
            clipped_share=0.0 * one,
            limit_dn=nan,
            rejected_share=0.0,
            common_dn2=nan[:1],
            line_covariance_dn2=nan,
        )
        for k, t in enumerate((10.0, 10.0, 100.0, 100.0, 500.0, 500.0, 1000.0, 1000.0))
    ]


@pytest.mark.parametrize("seed", range(4))
def test_dark_charge_is_told_from_the_dark_level(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tap, pixels = np.zeros(40, np.intp), np.ones(40)
    blocks = darks(2e-3, rng)
    found = dark_level(blocks, tap, pixels)
    std = 0.3 / np.sqrt(40) / np.sqrt(2 * np.var([10.0, 100.0, 500.0, 1000.0]) * 4)
    assert abs(found.growth_dn_per_us[0] - 2e-3) < 5 * std
    assert abs(found.offset_dn.mean() - (blocks[0].mean_dn.mean() - 0.02)) < 5 * 0.3 / np.sqrt(40)
    still = dark_level(darks(0.0, rng), tap, pixels)
    assert still.growth_dn_per_us[0] == 0.0


def test_dark_charge_has_shot_noise_that_is_not_read_noise() -> None:
    rng = np.random.default_rng(11)
    drawn = recording("straight", 100, 300, rng, (0.05, 0.2, 0.4, 0.6, 0.8))
    blocks, frames = list(drawn.header.blocks), dict(drawn.stretches)
    for k, exposure in enumerate((100.0, 400.0, 700.0, 1000.0)):
        charge = rng.poisson(exposure * 0.16, (100, 300))
        codes = np.rint(GAIN * charge + READ_DN * rng.standard_normal(charge.shape) + 100.0)
        blocks.append(Block(block=f"d{k}", kind="dark", exposure_us=exposure, lines=100))
        frames[f"d{k}"] = (codes.astype(np.uint16),)
    blocks = [b for b in blocks if b.kind == "flat" or b.block.startswith("d")]
    header = drawn.header.model_copy(update={"blocks": tuple(blocks)})
    found = photon_transfer(replace(drawn, header=header, stretches=frames))
    assert abs(found.curve.dark.growth_dn_per_us[0] - GAIN * 0.16) < 0.02 * GAIN * 0.16
    assert abs(found.read_noise_dn.value - READ_DN) < 4 * found.read_noise_dn.std


@pytest.mark.parametrize("seed", range(3))
def test_scatter_beyond_statistics_is_measured(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, own, size = 400, np.full(400, 1.0), rng.uniform(50.0, 200.0, 400) ** 2
    residual = rng.standard_normal(n) * np.sqrt(own + 0.02**2 * size)
    found = excess(residual, own, size, n)
    # τ from n residuals: as sure as a spread, once it is as large as statistics or larger.
    assert abs(found.relative / 0.02 - 1) < 5 / np.sqrt(n)
    with_it = deviance(residual, own, size)
    assert with_it < np.sum(residual**2 / own + np.log(2 * np.pi * own)) - 100


def test_scatter_that_chance_may_be_counts_for_means_alone() -> None:
    own, size = np.ones(10), np.full(10, 1e4)
    residual = 1.2 * np.array([1.0, -1.0] * 5)
    assert excess(residual, own, size, 10).relative == 0.0
    assert excess(residual, own, size, 10, least_likely=1.0).relative == pytest.approx(
        np.sqrt(0.44e-4)
    )
    assert excess(residual / 2, own, size, 10, least_likely=1.0).relative == 0.0


@pytest.mark.parametrize("seed", range(2))
def test_a_variance_that_scatters_more_makes_the_gain_less_sure(seed: int) -> None:
    rng = np.random.default_rng(seed)
    drawn = recording("straight", 100, 400, rng)
    quiet = photon_transfer(drawn)
    frames = {}
    for block in drawn.header.blocks:
        (dn,) = drawn.stretches[block.block]
        stretched = dn.astype(np.float64)
        mean = stretched.mean(axis=0)
        # Noise of a block as a whole larger or smaller by 3 %: the signal stays.
        noise = (stretched - mean) * (1.0 + 0.03 * rng.standard_normal())
        frames[block.block] = (np.clip(np.rint(mean + noise), 0, 4095).astype(np.uint16),)
    loud = photon_transfer(replace(drawn, stretches=frames))
    fit = loud.taps[0].choice.fit
    assert fit.variance_excess.flats.relative > 0.02
    assert loud.system_gain.std > 1.5 * quiet.system_gain.std
    assert abs(loud.system_gain.value - GAIN) < 4 * loud.system_gain.std


def test_no_trial_of_a_charge_that_attracts_overflows_and_none_repelled_is_changed() -> None:
    # Trials reach exponents of thousands where a sensor lags by 0.6 and blocks have 16 lines.
    t = np.array([-800.0, -1.0, -1e-3, 0.0, 0.5, MOST_EXPONENT])
    exact = np.array([1.0 if each == 0 else np.expm1(each) / each for each in t])
    np.testing.assert_allclose(exponential_share(t), exact, rtol=1e-15)
    beyond = np.array([1.0, 1.0 + 1e-6, 2.0, 800.0, 1e6])
    with np.errstate(all="raise"):
        exponential = exponential_share(beyond) * beyond
    slope = np.diff(exponential) / np.diff(beyond)
    np.testing.assert_allclose(slope, np.e, rtol=1e-8)
