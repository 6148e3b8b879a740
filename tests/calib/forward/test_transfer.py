"""Charge that is deferred on its way to the output."""

import numpy as np
import pytest
from scipy.stats import poisson

from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effects.cti import Cti
from calib.forward.partition import part_of
from calib.forward.taps import tap_of_column
from tests.calib.forward.plain_sensor import covariance, plain, score

AT = Conditions.steady(1, exposure_us=50.0, line_period_us=100.0)
RNG = np.random.default_rng(0)
seeds = pytest.mark.parametrize("seed", [1, 2, 3])


def exactly(**given: float | str) -> Cti:
    return Cti(partition_noise=0.0, **({"exponent": 1.0, "trail_columns": 0.0} | given))  # type: ignore[arg-type]


@seeds
def test_independent_electrons_split_binomially_and_stay_poisson(seed: int) -> None:
    rng, n, m, share = np.random.default_rng(seed), 400_000, 60.0, 0.1
    charge = rng.poisson(m, n).astype(float)
    gone = part_of(charge, share, 1.0, rng)
    for part, mean in ((gone, m * share), (charge - gone, m * (1 - share))):
        assert score(part.mean(), mean, np.sqrt(mean / n)) < 5
        assert score(part.var(), mean, mean * np.sqrt((2 + 1 / mean) / n)) < 5
    both = np.mean((gone - gone.mean()) * (charge - gone - (charge - gone).mean()))
    assert score(both, 0.0, m * np.sqrt(share * (1 - share) / n)) < 5


def test_each_transfer_leaves_the_share_behind_for_the_next_pixel() -> None:
    e, q = 0.003, 800.0
    read = exactly(per_transfer=e).apply(np.full((1, 50), q), AT, RNG)[0]
    late = [q * (1 - (1 - e) ** k) for k in range(1, 51)]
    assert read[0] == pytest.approx(q - late[0], rel=1e-12)
    for k in range(1, 50):
        assert read[k] == pytest.approx(q - late[k] + late[k - 1], rel=1e-12)


def test_small_charges_lose_more_by_the_power_law() -> None:
    charge = np.array([[100.0, 10_000.0]])
    share = Cti(per_transfer=1e-5, exponent=0.7, reference_e=10_000.0).deferred_share(charge)[0]
    assert share[0] / (share[1] / 2) == pytest.approx(100.0**0.3, rel=1e-4)


@pytest.mark.parametrize("partition_noise", [0.0, 1.0])
def test_a_bright_column_trails_exponentially_away_from_the_output(partition_noise: float) -> None:
    e, n_lines, at_column, length = 0.005, 4000, 60, 1.7
    line = np.zeros((n_lines, 100))
    line[:, at_column] = 20_000.0
    cti = Cti(
        per_transfer=e,
        exponent=1.0,
        trail_columns=length,
        partition_noise=partition_noise,
    )
    read = cti.apply(line, AT, np.random.default_rng(5)).mean(0)
    late = 20_000.0 * (1 - (1 - e) ** (at_column + 1))
    assert not read[:at_column].any()
    g = np.exp(-1 / length)
    for k in range(1, 8):
        wanted = late * (1 - g) * g ** (k - 1)
        spread = np.sqrt(wanted / n_lines) * partition_noise + 1e-9 * wanted
        assert score(read[at_column + k], wanted, spread) < 5
    assert score(read[at_column], 20_000.0 - late, np.sqrt(late / n_lines) + 1e-9) < 5


def test_outputs_at_the_right_and_at_both_ends_mirror_the_one_at_the_left() -> None:
    line = np.random.default_rng(2).uniform(100.0, 900.0, (3, 11))
    given = {"per_transfer": 0.01, "exponent": 0.8, "trail_columns": 1.0}
    left, right, both = (exactly(readout=r, **given) for r in ("left", "right", "both"))
    flipped = left.apply(line[:, ::-1], AT, RNG)[:, ::-1]
    assert np.array_equal(right.apply(line, AT, RNG), flipped)
    halves = both.apply(line, AT, RNG)
    assert np.array_equal(halves[:, :6], left.apply(line[:, :6], AT, RNG))
    assert np.array_equal(halves[:, 6:], right.apply(line[:, 6:], AT, RNG))


@pytest.mark.parametrize("readout", ["left", "right", "both"])
@pytest.mark.parametrize("layout", ["odd_even", "halves", "quarters", "quadrants"])
def test_each_tap_has_a_register_of_its_own(layout: str, readout: str) -> None:
    line = np.random.default_rng(4).uniform(100.0, 900.0, (3, 11))
    given = {"per_transfer": 0.01, "exponent": 1.4, "trail_columns": 1.0}
    read = exactly(readout=readout, tap_layout=layout, **given).apply(line, AT, RNG)
    along = "halves" if layout == "quadrants" else layout
    taps = tap_of_column(along, 11)
    n_taps = int(taps.max()) + 1
    for tap in range(n_taps):
        # The outer half of the taps is read to the right where both ends have outputs.
        towards = {"both": "left" if tap < n_taps / 2 else "right"}.get(readout, readout)
        alone = exactly(readout=towards, **given).apply(line[:, taps == tap], AT, RNG)
        assert np.array_equal(read[:, taps == tap], alone)


@seeds
@pytest.mark.parametrize("p", [0.0, 1.0])
def test_neighbours_correlate_only_where_the_share_is_set_for_all_electrons(
    seed: int, p: float
) -> None:
    e, m, n, k = 0.01, 500.0, 2000, 40
    rng = np.random.default_rng(seed)
    charge = rng.poisson(m, (n, 200)).astype(float)
    cti = Cti(per_transfer=e, exponent=1.0, trail_columns=0.0, partition_noise=p)
    read = cti.apply(charge, AT, rng)
    columns = np.arange(k, 200)
    late = 1 - (1 - e) ** (columns + 1.0)
    before = 1 - (1 - e) ** columns.astype(float)
    smooth = m * ((1 - late) ** 2 + before**2)
    mean = m * (1 - late + before)
    # Counts: mean and variance are the same. Shares: a linear filter of the counts.
    wanted = mean if p else smooth
    size = n * columns.size
    found = np.mean(read[:, columns].var(0, ddof=1))
    assert score(found, wanted.mean(), wanted.mean() * np.sqrt(2.5 / size)) < 5
    covary = 0.0 if p else np.mean(m * (late * (1 - late))[:-1])
    found = covariance(read[:, columns[:-1]], read[:, columns[1:]])
    assert score(found, covary, m * np.sqrt(1.0 / size)) < 5


@seeds
def test_by_the_power_law_even_independent_electrons_make_neighbours_anticorrelate(
    seed: int,
) -> None:
    e, m, n, exponent = 0.01, 50.0, 4000, 0.5
    rng = np.random.default_rng(seed)
    cti = Cti(per_transfer=e, reference_e=50.0, exponent=exponent, trail_columns=0.0)
    read = cti.apply(rng.poisson(m, (n, 120)).astype(float), AT, rng)
    # Var(deferred) exceeds Cov(charge, deferred): summed over the counts and their chances.
    counts = np.arange(1, 200)
    chance = poisson.pmf(counts, m)
    wanted = []
    for k in range(20, 119):
        share = 1 - (1 - e * (counts / 50.0) ** (exponent - 1)) ** (k + 1)
        deferred = counts * share
        mean = np.sum(chance * deferred)
        variance = np.sum(chance * (deferred * (1 - share) + deferred**2)) - mean**2
        wanted.append(np.sum(chance * counts * deferred) - m * mean - variance)
    found = covariance(read[:, 20:119], read[:, 21:120])
    assert np.mean(wanted) < -1.0
    assert score(found, float(np.mean(wanted)), m / np.sqrt(n * 99)) < 5


def test_rows_of_a_frame_are_read_one_by_one() -> None:
    frame = np.random.default_rng(2).uniform(100.0, 900.0, (2, 5, 12))
    cti = exactly(per_transfer=0.01, trail_columns=2.0)
    rows = cti.apply(frame.reshape(10, 12), AT, RNG)
    assert np.array_equal(cti.apply(frame, AT, RNG), rows.reshape(2, 5, 12))


def test_the_outputs_have_to_be_the_cameras() -> None:
    with pytest.raises(InputError, match="readout is 'both'") as caught:
        plain(Cti(readout="both"))
    assert caught.value.code == "readout-mismatch"
    assert plain(Cti(readout="both"), more='readout = "both"').effect("cti") is not None


def test_registers_of_taps_have_to_be_those_of_the_cameras_taps() -> None:
    with pytest.raises(InputError, match="tap_layout is 'odd_even'") as caught:
        plain(Cti(tap_layout="odd_even"))
    assert caught.value.code == "tap-layout-mismatch"
    two = 'taps = 2\ntap_layout = "odd_even"'
    for layout in ("odd_even", "single"):
        assert plain(Cti(tap_layout=layout), more=two).effect("cti") is not None
