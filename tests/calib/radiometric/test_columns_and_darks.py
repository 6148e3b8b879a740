from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.block_noise import BlockNoise
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.dark_comparison import compare_darks
from calib.radiometric.estimation.dark_current import DarkCurrent
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.radiometric.estimation.noise_model import NoiseModel
from calib.recording.block_statistics import BlockStatistics, RecordingStatistics
from tests.calib.radiometric.simulated import Bench, Drawn, draw

BENCH = Bench(n=128, lines=48)


def determined(bench: Bench, statistics: RecordingStatistics) -> Determined:
    return determine(statistics, bench.header(), Provenance("0" * 64))


def with_column(
    statistics: RecordingStatistics, column: int, codes: NDArray[np.float64]
) -> RecordingStatistics:
    """Replace one column of every block by codes of the block's mean, (n_blocks, n_lines)."""
    changed = []
    for block, dn in zip(statistics.fit, codes, strict=True):
        clipped = np.clip(np.rint(dn), 0, 4095)
        new = {
            "mean_dn": clipped.mean(),
            "variance_dn2": clipped.var(ddof=1),
            "n_at_zero": (clipped == 0).sum(),
            "n_at_full_scale": (clipped == 4095).sum(),
        }
        arrays = {name: getattr(block, name).copy() for name in new}
        for name, value in new.items():
            arrays[name][column] = value
        changed.append(BlockStatistics(block.block, block.n_lines, **arrays))
    return RecordingStatistics(tuple(changed))


@pytest.mark.parametrize(
    ("state", "mean"),
    [
        (ColumnState.DEAD, lambda d: np.full(len(d.noise_free), 17.0)),
        (ColumnState.DEAD, lambda d: np.zeros(len(d.noise_free))),
        (ColumnState.NEVER_LIT, lambda d: np.full(len(d.noise_free), 60.0)),
        (ColumnState.NEVER_LIT, lambda d: 60.0 + 0.05 * (d.noise_free[:, 40] - d.offset[40])),
        (ColumnState.HOT, lambda d: d.noise_free[:, 40] + 900.0),
        (ColumnState.SATURATED, lambda d: d.noise_free[:, 40] + 20000.0),
        (ColumnState.VALID, lambda d: 60.0 + 0.6 * (d.noise_free[:, 40] - d.offset[40])),
    ],
    ids=["stuck", "black", "noise-only", "hardly-lit", "hot", "saturated", "dusty"],
)
def test_a_column_is_masked_with_its_reason(
    state: ColumnState, mean: Callable[[Drawn], NDArray[np.float64]]
) -> None:
    rng = np.random.default_rng()
    drawn = draw(BENCH, rng, pixels=True)
    noise = 0.0 if state == ColumnState.DEAD else 1.5
    level = mean(drawn)[:, None] + noise * rng.standard_normal((len(drawn.noise_free), 48))
    found = determined(BENCH, with_column(drawn.statistics, 40, level)).coefficients
    assert ColumnState(found.reason[40]) == state
    others = np.delete(np.arange(128), 40)
    assert (found.reason[others] == ColumnState.VALID).all()
    if state != ColumnState.VALID:
        assert np.isnan(found.responsivity[40])
        assert np.isnan(found.slope[40])
        assert np.isfinite(found.vignette[40])


def test_masked_columns_leave_the_others_as_they_were() -> None:
    rng = np.random.default_rng()
    drawn = draw(BENCH, rng, pixels=True)
    stuck = np.full((len(drawn.noise_free), 48), 17.0)
    clean = determined(BENCH, drawn.statistics).coefficients
    masked = determined(BENCH, with_column(drawn.statistics, 40, stuck)).coefficients
    others = np.delete(np.arange(128), 40)
    away = np.abs(masked.slope - clean.slope)[others] / clean.slope_std[others]
    assert away.max() < 0.1


def test_a_dark_that_clips_is_left_out_of_the_comparison() -> None:
    bench = replace(BENCH, offset_mean=3.0, offset_std=4.0, darks=6)
    drawn = draw(bench, np.random.default_rng(), pixels=True)
    found = determined(bench, drawn.statistics)
    darks = found.darks
    assert darks is not None
    assert darks.clipping_columns > 20
    assert darks.capped_mean_dn > drawn.offset.mean() + 0.2
    assert abs(darks.significance_sigma) < 5
    assert any("clip at 0 in the dark" in text for text in found.warnings)


def test_stray_light_in_the_darks_is_significant() -> None:
    drawn = draw(BENCH, np.random.default_rng(), pixels=True)
    lifted = tuple(
        replace(s, mean_dn=s.mean_dn + 10.0) if s.block.kind == "dark" else s
        for s in drawn.statistics.fit
    )
    found = determined(BENCH, RecordingStatistics(lifted))
    assert found.darks is not None
    assert found.darks.difference_dn == pytest.approx(10.0, abs=5 * found.darks.difference_std_dn)
    assert found.darks.significance_sigma > 6
    assert any("differ by" in text for text in found.warnings)


def test_dark_current_is_taken_off_the_responsivity() -> None:
    bench = replace(BENCH, dark_current=0.1, darks=5)
    drawn = draw(bench, np.random.default_rng(), pixels=True)
    found = determined(bench, drawn.statistics)
    c = found.coefficients
    assert np.mean(c.dark_current_dn_per_us) == pytest.approx(0.1, rel=0.05)
    z = (c.slope / (drawn.vignette * drawn.responsivity) - 1) / (c.slope_std / c.slope)
    assert abs(np.mean(z - z.mean())) < 1e-9
    assert any("The dark grows by" in text for text in found.warnings)


def test_a_hot_columns_own_dark_current_is_taken_off() -> None:
    """10 DN at the longest exposure, where the mean over columns shows nothing."""
    bench = replace(BENCH, darks=5, certificate=0.0, level_error=0.0)
    slope_z, current_z = [], []
    for rng in np.random.default_rng().spawn(40):
        drawn = draw(bench, rng)
        hot = []
        for s in drawn.statistics.fit:
            mean_dn = s.mean_dn.copy()
            mean_dn[40] += 0.02 * s.block.exposure_us
            hot.append(replace(s, mean_dn=mean_dn))
        found = determined(bench, RecordingStatistics(tuple(hot)))
        c = found.coefficients
        u = np.hypot(c.slope_std[40], c.slope[40] * c.scale_relative_std)
        slope_z.append((c.slope[40] - drawn.vignette[40] * drawn.responsivity[40]) / u)
        current = c.dark_current_dn_per_us[40] - 0.02
        current_z.append(current / c.dark_current_dn_per_us_std[40])
        assert any("1 columns grow otherwise in the dark" in text for text in found.warnings)
    assert abs(np.mean(slope_z)) < 4 / np.sqrt(40)
    assert abs(np.mean(current_z)) < 4 / np.sqrt(40)
    assert np.std(current_z) < 1 + 4 / np.sqrt(80)


def test_columns_that_differ_in_dark_current_have_their_own() -> None:
    """Their scatter, as large as what darks tell of one column, is weighed against that."""
    bench = replace(BENCH, n=512, darks=5)
    rng, square = np.random.default_rng(), []
    for _ in range(10):
        drawn = draw(bench, rng)
        truth = 0.02 + 6e-4 * rng.standard_normal(bench.n)
        warm = [
            replace(s, mean_dn=s.mean_dn + truth * s.block.exposure_us)
            for s in drawn.statistics.fit
        ]
        c = determined(bench, RecordingStatistics(tuple(warm))).coefficients
        away = c.dark_current_dn_per_us - truth
        square.append(np.mean((away / c.dark_current_dn_per_us_std) ** 2))
        # A darks' line tells 6.7e-4: weighed, half of the variance of either is left.
        assert np.std(away) < 0.85 * 6e-4
    # Where the deviation is large, the larger of two variances is stated.
    assert np.mean(square) < 1 + 4 * np.sqrt(2 / 5120)
    assert np.mean(square) > 0.6


def test_line_noise_is_not_taken_for_a_dark_current_with_one_dark_per_exposure() -> None:
    bench = replace(BENCH, line_noise_dn=2.0, darks=5, levels=())
    said = 0
    for rng in np.random.default_rng().spawn(60):
        found = determined(bench, draw(bench, rng).statistics)
        said += any("The dark grows by" in text for text in found.warnings)
    # Student's t with 3 degrees of freedom exceeds 5·√3 once in 600: three in 60 are no chance.
    assert said < 3


def test_a_response_that_bends_is_said() -> None:
    drawn = draw(BENCH, np.random.default_rng(), pixels=True)
    bent = tuple(
        replace(s, mean_dn=s.mean_dn * (1 - 2e-5 * s.mean_dn)) for s in drawn.statistics.fit
    )
    found = determined(BENCH, RecordingStatistics(bent))
    assert (found.coefficients.reduced_chi_squared or 0) > 3
    assert any("do not fit within the noise" in text for text in found.warnings)


def test_saturated_blocks_do_not_bend_the_line() -> None:
    bench = replace(BENCH, exposures=(100.0, 200.0, 300.0, 400.0, 800.0, 1600.0))
    drawn = draw(bench, np.random.default_rng(), pixels=True)
    c = determined(bench, drawn.statistics).coefficients
    z = (c.dark_offset_dn - drawn.offset) / c.dark_offset_dn_std
    assert c.valid.all()
    assert abs(z.std() - 1) < 0.35
    assert (c.reduced_chi_squared or 9) < 1.5


@pytest.mark.parametrize("line_noise_dn", [0.0, 2.0])
def test_capped_darks_and_intercepts_differ_by_chance_as_much_as_is_stated(
    line_noise_dn: float,
) -> None:
    rng, n = np.random.default_rng(), 150
    bench = replace(BENCH, line_noise_dn=line_noise_dn, darks=10)
    found = [determined(bench, draw(bench, rng).statistics).darks for _ in range(n)]
    z = np.array([d.significance_sigma for d in found if d is not None])
    assert len(z) == n
    assert abs(z.mean()) < 4 / np.sqrt(n)
    assert abs(z.std() - 1) < 0.1 + 4 / np.sqrt(2 * n)


@pytest.mark.parametrize("n_darks", [3, 4, 5])
def test_with_few_darks_and_line_noise_they_differ_by_two_sigma_once_in_twenty(
    n_darks: int,
) -> None:
    rng, n = np.random.default_rng(), 60
    bench = replace(BENCH, line_noise_dn=2.0, dark_current=0.05, darks=n_darks, levels=())
    found = [determined(bench, draw(bench, rng).statistics).darks for _ in range(n)]
    within = [abs(d.significance_sigma) < 2 for d in found if d is not None]
    assert np.mean(within) > 0.9545 - 4 * np.sqrt(0.9545 * 0.0455 / n)


def test_darks_of_one_exposure_err_together_by_the_blocks_common_offset() -> None:
    bench, n, z = replace(BENCH, line_noise_dn=2.0, darks=6), 400, []
    of_block = BlockNoise(2.0**2 / bench.lines, 1000, 1.0)
    for rng in np.random.default_rng().spawn(n):
        drawn = draw(bench, rng)
        found = compare_darks(
            BlockTable.of_kind(drawn.statistics.fit, "dark"),
            NoiseModel(bench.gain, bench.read_dn**2 + bench.line_noise_dn**2, 0.0, 0.0),
            DarkCurrent.none(bench.n),
            offset_dn=drawn.offset,
            shared_offset_variance=0.0,
            block_noise=of_block,
            valid=np.ones(bench.n, np.bool_),
        )
        assert found is not None
        z.append(found.significance_sigma)
    assert abs(np.mean(z)) < 4 / np.sqrt(n)
    assert abs(np.std(z) - 1) < 4 / np.sqrt(2 * n)
