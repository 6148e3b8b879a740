"""Photons of a source by Eq. 21, their bounds and uncertainty; photons from photo-electrons."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from calib.errors import InputError
from calib.transfer.estimate import Estimate
from calib.transfer.source_radiometry import yielding_2018 as paper
from calib.transfer.source_radiometry.bounded import Bounded
from calib.transfer.source_radiometry.diverging_source import (
    DivergingSource,
    photons_through_aperture,
)
from calib.transfer.source_radiometry.photons_from_electrons import photons_from_electrons
from calib.transfer.source_radiometry.source_photons import source_photons

LED = paper.LED555L


def test_a_cone_through_its_whole_disc_gives_every_photon() -> None:
    """An aperture as large as the disc, evenly lit: power x time over a photon's energy."""
    radius_m = 2.0 * math.tan(math.radians(30.0))
    photons = photons_through_aperture(
        power_w=1e-3, wavelength_nm=500.0, half_angle_deg=30.0, peak_over_mean=1.0,
        distance_m=2.0, aperture_radius_m=radius_m, exposure_s=0.5,
    )  # fmt: skip
    # 500 nm: h nu = 6.62607015e-34 J s x 299792458 m/s / 500e-9 m = 3.97289171e-19 J.
    assert photons == pytest.approx(0.5e-3 / 3.97289171e-19, rel=1e-8)


def test_the_papers_inputs_give_the_figures_worked_out_by_hand() -> None:
    """hc/555 nm = 3.57918e-19 J; disc of 4.33 m x tan 20 deg = 1.57599 m."""
    by_hand = 2.0 * (1e-4 / 1.57599) ** 2 * 1e-3 * 0.1 / 3.57918e-19
    assert LED.nominal() == pytest.approx(by_hand, rel=1e-5)


def test_the_printed_nominal_is_a_little_low_and_the_printed_bounds_are_swapped_and_off() -> None:
    low, high = LED.corners()
    assert paper.PRINTED_THEORETICAL / LED.nominal() - 1 == pytest.approx(-0.004, abs=0.0005)
    assert paper.PRINTED_LOWER_BOUND > paper.PRINTED_UPPER_BOUND
    assert paper.PRINTED_UPPER_BOUND / low - 1 == pytest.approx(-0.013, abs=0.0005)
    assert paper.PRINTED_LOWER_BOUND / high - 1 == pytest.approx(+0.005, abs=0.0005)


def test_the_printed_error_does_not_follow_from_the_printed_photons() -> None:
    by_table = 1 - paper.PRINTED_SANUC / paper.PRINTED_THEORETICAL
    assert by_table == pytest.approx(0.025, abs=0.0005)
    assert abs(by_table - paper.PRINTED_ABSOLUTE_ERROR) > 0.001
    assert 1 - paper.PRINTED_SANUC / LED.nominal() == pytest.approx(0.029, abs=0.0005)


def test_no_corner_of_the_inputs_lies_outside_of_the_bounds() -> None:
    wide = replace(
        LED,
        half_angle_deg=Bounded(20.0, 18.0, 23.0, "deg"),
        aperture_radius_m=Bounded(1e-4, 0.9e-4, 1.2e-4, "m"),
    )
    names = list(wide.inputs())
    ends = [(given.low, given.high) for given in wide.inputs().values()]
    corners = [
        photons_through_aperture(**dict(zip(names, corner, strict=True)))
        for corner in product(*ends)
    ]
    assert wide.corners() == pytest.approx((min(corners), max(corners)), rel=1e-12)


def test_the_monte_carlo_has_the_spread_of_the_law_of_propagation() -> None:
    """Half-widths of a few percent: what the first order leaves out is far below the error."""
    found = source_photons(LED, np.random.default_rng(3), n_draws=100_000)
    assert found.estimate.std == pytest.approx(
        found.budget.combined, rel=5 * found.monte_carlo_relative_std + 1e-3
    )
    relative = {row.quantity: row.contribution / found.nominal for row in found.budget.rows}
    # Rectangular: half-width / sqrt(3), times the exponent with which Eq. 21 holds the input.
    by_hand = {
        "power_w": 0.05,
        "wavelength_nm": 10 / 555,
        "peak_over_mean": 0.0405 / 2,
        "distance_m": 2 * 0.005 / 4.33,
        "exposure_s": 0.001,
    }
    assert set(relative) == set(by_hand)
    for name, half_width in by_hand.items():
        assert relative[name] == pytest.approx(half_width / math.sqrt(3), rel=1e-4)


def test_the_angle_enters_by_its_tangent() -> None:
    known = {name: Bounded.exact(given.value, given.unit) for name, given in LED.inputs().items()}
    source = DivergingSource(**{**known, "half_angle_deg": Bounded(20.0, 19.5, 20.5, "deg")})
    (row,) = source_photons(source, np.random.default_rng(1)).budget.rows
    angle = math.radians(20.0)
    slope = -2 / (math.sin(angle) * math.cos(angle)) * math.radians(1.0)
    assert row.sensitivity == pytest.approx(slope * source.nominal(), rel=1e-6)


@pytest.mark.parametrize("coverage", [0.5, 0.95])
def test_the_interval_holds_its_share_of_sources(coverage: float) -> None:
    found = source_photons(LED, np.random.default_rng(4), n_draws=50_000, coverage=coverage)
    n = 50_000
    fresh = np.random.default_rng(5)
    others = photons_through_aperture(
        **{name: given.drawn(n, fresh) for name, given in LED.inputs().items()}
    )
    below, above = others < found.interval[0], others > found.interval[1]
    tail = (1 - coverage) / 2
    # Both the interval's ends and the share outside scatter, each like a share of n.
    error = math.sqrt(2 * tail * (1 - tail) / n)
    assert below.mean() == pytest.approx(tail, abs=5 * error)
    assert above.mean() == pytest.approx(tail, abs=5 * error)
    assert found.low < others.min()
    assert others.max() < found.high


def test_the_same_generator_gives_the_same_answer() -> None:
    first, again = (source_photons(LED, np.random.default_rng(1)).answer() for _ in range(2))
    assert first == again
    assert first["photons"]["unit"] == "photon"


def test_photons_carry_the_uncertainties_of_electrons_and_efficiency() -> None:
    found = photons_from_electrons(Estimate(5000.0, 30.0, "e-"), Estimate(0.5, 0.01, "e-/photon"))
    assert found.value == 10_000.0
    assert found.std == pytest.approx(10_000.0 * math.hypot(0.006, 0.02))


def test_z_scores_of_photons_have_mean_0_and_standard_deviation_1() -> None:
    n, rng = 20_000, np.random.default_rng(8)
    electrons, efficiencies = rng.normal(1e4, 50.0, n), rng.normal(0.55, 0.0055, n)
    found = [
        photons_from_electrons(Estimate(e, 50.0, "e-"), Estimate(q, 0.0055, "e-/photon"))
        for e, q in zip(electrons, efficiencies, strict=True)
    ]
    z = np.array([(each.value - 1e4 / 0.55) / each.std for each in found])
    # 1/QE is curved: of second order, its mean moves by the square of 1 %, or 0.01 standard
    # deviations.
    assert abs(z.mean()) < 4 / math.sqrt(n) + 0.01
    assert abs(z.std() - 1) < 4 / math.sqrt(2 * n) + 0.001


def test_what_is_not_known_stays_unknown_with_its_reason() -> None:
    known, unknown = Estimate(0.5, 0.0, "e-/photon"), Estimate.unknown("e-", "no light fell")
    assert photons_from_electrons(unknown, known).reason == "no light fell"
    other = photons_from_electrons(
        Estimate(1.0, 1.0, "e-"), Estimate.unknown("e-/photon", "no data sheet")
    )
    assert (other.is_known, other.reason) == (False, "no data sheet")


@pytest.mark.parametrize(("value", "std"), [(0.0, 0.1), (1.2, 0.1), (-0.5, 0.1), (0.5, math.nan)])
def test_an_impossible_efficiency_is_refused(value: float, std: float) -> None:
    with pytest.raises(InputError, match="quantum efficiency") as caught:
        photons_from_electrons(Estimate(1.0, 0.1, "e-"), Estimate(value, std, "e-/photon"))
    assert caught.value.code == "bad-quantum-efficiency"


BAD_BOUNDS = {
    "value outside": (1.0, 1.1, 1.2),
    "swapped": (1.0, 1.2, 0.8),
    "zero": (0.0, 0.0, 1.0),
    "infinite": (1.0, 0.5, math.inf),
    "not a number": (math.nan, 0.5, 1.5),
}


@pytest.mark.parametrize("numbers", BAD_BOUNDS.values(), ids=BAD_BOUNDS)
def test_bounds_that_bound_nothing_are_refused(numbers: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="between") as caught:
        Bounded(*numbers, "m")
    assert caught.value.code == "bad-bounds"


def test_a_wrong_unit_and_a_flat_cone_are_refused() -> None:
    with pytest.raises(InputError, match="power_w is given in mW; give it in W") as caught:
        replace(LED, power_w=Bounded.exact(1.0, "mW"))
    assert caught.value.code == "wrong-unit"
    with pytest.raises(InputError, match="less than 90"):
        replace(LED, half_angle_deg=Bounded(80.0, 70.0, 90.0, "deg"))


@pytest.mark.parametrize("options", [{"n_draws": 10}, {"coverage": 1.0}, {"coverage": 0.0}])
def test_a_monte_carlo_that_says_nothing_is_refused(options: dict[str, float]) -> None:
    with pytest.raises(InputError) as caught:
        source_photons(LED, np.random.default_rng(1), **options)  # type: ignore[arg-type]
    assert caught.value.code == "bad-monte-carlo"
