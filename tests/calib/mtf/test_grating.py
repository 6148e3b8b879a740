import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.mtf.grating.grating import Grating, UnwantedOrder
from calib.mtf.grating.orders import circle_orders
from calib.mtf.grating.pattern import intensity, on_grid
from calib.mtf.grating.source import Source
from tests.calib.mtf.simulated import ORDERS_12, ORDERS_24, ORDERS_48

GRATINGS = [ORDERS_12, ORDERS_24, ORDERS_48]


@pytest.mark.parametrize(
    ("grating", "orders", "harmonics", "highest"),
    [(ORDERS_24, 24, 288, 0.102), (ORDERS_48, 48, 1152, 0.120)],
)
def test_orders_harmonics_and_reach_are_those_of_the_paper(
    grating: Grating, orders: int, harmonics: int, highest: float
) -> None:
    assert grating.n_orders == orders
    assert grating.harmonics.count == harmonics
    assert grating.max_frequency_per_um == pytest.approx(highest, abs=5e-5)
    reach = np.hypot(*grating.harmonics.frequency_per_um.T)
    assert reach.max() == pytest.approx(grating.max_frequency_per_um, rel=1e-12)


@pytest.mark.parametrize("grating", GRATINGS)
def test_the_image_is_the_squared_modulus_of_the_orders_sum(grating: Grating) -> None:
    x, y = default_rng().uniform(-900, 900, (2, 40))
    turns = np.multiply.outer(x, circle_orders(grating.eta2)[:, 0]) + np.multiply.outer(
        y, circle_orders(grating.eta2)[:, 1]
    )
    field = np.exp(2j * np.pi * turns / grating.period_um).sum(1)
    expected = np.abs(field) ** 2 / grating.n_orders
    np.testing.assert_allclose(intensity(grating.harmonics, x, y), expected, atol=1e-10)


def test_a_grid_has_the_same_values_as_single_points() -> None:
    rng = default_rng()
    x, y = rng.uniform(-300, 300, 7), rng.uniform(-300, 300, 5)
    on_points = intensity(ORDERS_24.harmonics, *np.meshgrid(x, y))
    np.testing.assert_allclose(on_grid(ORDERS_24.harmonics, x, y), on_points, atol=1e-11)


@pytest.mark.parametrize("grating", GRATINGS)
def test_the_lattice_leaves_the_pattern_as_it_is_and_half_of_it_does_not(grating: Grating) -> None:
    x, y = default_rng().uniform(-300, 300, (2, 50))
    before = intensity(grating.harmonics, x, y)
    for dx, dy in grating.harmonics.lattice_um:
        np.testing.assert_allclose(intensity(grating.harmonics, x + dx, y + dy), before, atol=1e-9)
    first, second = grating.harmonics.lattice_um
    for dx, dy in (first / 2, second / 2, (first + second) / 2):
        assert np.abs(intensity(grating.harmonics, x + dx, y + dy) - before).max() > 0.1


def test_orders_that_are_all_odd_halve_the_period() -> None:
    np.testing.assert_allclose(np.abs(ORDERS_24.harmonics.lattice_um), np.diag([250.0, 250.0]))


def test_the_shortest_shift_is_the_same_shift_and_no_longer_than_its_neighbours() -> None:
    harmonics = ORDERS_48.harmonics
    first, second = harmonics.lattice_um
    short = np.array([31.0, -17.0])
    np.testing.assert_allclose(harmonics.shortest(short + 3 * first - 5 * second), short, atol=1e-9)


def test_an_unwanted_order_adds_its_fringes_with_the_wanted_ones() -> None:
    weak = UnwantedOrder(3, 4, 0.05j)
    grating = Grating(50, 340.0, (weak,))
    x, y = default_rng().uniform(-300, 300, (2, 30))
    orders = np.vstack([circle_orders(50), [(3, 4)]])
    fields = np.concatenate([np.ones(12), [0.05j]])
    turns = np.multiply.outer(x, orders[:, 0]) + np.multiply.outer(y, orders[:, 1])
    image = np.abs(np.exp(2j * np.pi * turns / 340.0) @ fields) ** 2
    expected = image / (12 + 0.05**2)
    np.testing.assert_allclose(intensity(grating.harmonics, x, y), expected, atol=1e-10)


def test_a_polychromatic_source_blurs_unwanted_fringes_and_leaves_the_pattern() -> None:
    weak = (UnwantedOrder(3, 4, 0.1),)
    lines = tuple(np.linspace(0.9, 1.7, 81))
    white = Grating(50, 340.0, weak, Source(lines, (1.0,) * 81, 2e5)).harmonics
    laser = Grating(50, 340.0, weak, Source((1.3,), (1.0,), 2e5)).harmonics
    pure = Grating(50, 340.0).harmonics
    mean = 1 + 0.1**2 / 12
    strength = {
        tuple(i): abs(a) * mean for i, a in zip(pure.index.tolist(), pure.amplitude, strict=True)
    }
    unwanted_of = {}
    for name, found in (("white", white), ("laser", laser)):
        pairs = zip(map(tuple, found.index.tolist()), np.abs(found.amplitude), strict=True)
        unwanted_of[name] = [size for index, size in pairs if index not in strength]
    assert max(unwanted_of["white"]) < 0.1 * max(unwanted_of["laser"])
    clean = [i for i in map(tuple, laser.index.tolist()) if i in strength]
    assert len(clean) == len(pure)


@pytest.mark.parametrize("eta2", [3, 0, -5, 21])
def test_a_radius_without_orders_is_refused(eta2: int) -> None:
    with pytest.raises(InputError, match="eta2") as refused:
        Grating(eta2, 500.0)
    assert refused.value.code == "no-orders"


@pytest.mark.parametrize("period", [0.0, -1.0, float("nan")])
def test_a_period_that_cannot_be_is_refused(period: float) -> None:
    with pytest.raises(InputError, match="period"):
        Grating(50, period)


def test_a_source_needs_a_weight_for_each_wavelength() -> None:
    with pytest.raises(InputError, match="weight"):
        Source((1.0, 1.1), (1.0,), 0.0)
