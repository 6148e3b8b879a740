"""The slanted edge: the same pixel seen by an edge, in one direction."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import NotDeterminedError
from calib.mtf.edge.edge_line import find_edge
from calib.mtf.edge.slanted_edge import slanted_edge
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.edge import edge_image, noisy
from calib.mtf.simulation.response import PixelResponse, centred
from calib.mtf.simulation.shapes import square
from tests.calib.mtf.simulated import CORNER, PITCH_UM, Scores

SHAPE = (200, 60)
SLANT = 0.0933  # 5.3°: columns per row
BINNING = 0.008
"""What bins of an eighth of the pitch are off by where rows do not fill them evenly."""


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("response", [square(25.0, 1.5), CORNER])
def test_the_transfer_function_across_the_edge_comes_out(
    response: PixelResponse, moving: bool
) -> None:
    light = edge_image(response, PITCH_UM, SHAPE, SLANT, moving=moving)
    found = slanted_edge(light, PITCH_UM, moving=moving)
    along = found.frequency_per_um
    across = (along * np.cos(found.angle_rad), -along * np.sin(found.angle_rad))
    error = found.transfer - centred(response, *across)
    assert found.angle_rad == pytest.approx(0.0 if moving else np.arctan(SLANT), abs=1e-4)
    assert np.abs(error).max() < BINNING
    assert found.transfer.real.min() < -0.1 or response is CORNER


def test_a_falling_edge_gives_what_a_rising_one_does() -> None:
    rising = slanted_edge(edge_image(CORNER, PITCH_UM, SHAPE, SLANT), PITCH_UM)
    falling = slanted_edge(2 - edge_image(CORNER, PITCH_UM, SHAPE, SLANT), PITCH_UM)
    np.testing.assert_allclose(falling.transfer, rising.transfer, atol=BINNING)


def test_uncertainties_are_the_scatter_of_noisy_images() -> None:
    rng, scores = default_rng(), Scores()
    light = edge_image(CORNER, PITCH_UM, SHAPE, SLANT)
    clean = slanted_edge(light, PITCH_UM).transfer
    noise = DetectorNoise(read_noise_e=300.0, shot_noise=True)
    for _ in range(60):
        found = slanted_edge(noisy(light, noise, rng), PITCH_UM)
        away = np.abs(found.transfer - clean)[1:] / found.std[1:]
        scores.squares.append(float((away**2).mean()))
    # The edge's place is fitted, too: its noise blurs, at the finest frequencies by some per cent.
    mean, root = np.mean(scores.squares), np.sqrt(len(scores.squares))
    assert abs(mean - 1) < 4.5 * np.std(scores.squares) / root + 0.1


def test_an_upright_edge_is_refused_since_it_samples_nothing_finely() -> None:
    with pytest.raises(NotDeterminedError, match="slant") as refused:
        find_edge(edge_image(CORNER, PITCH_UM, SHAPE, 0.0))
    assert refused.value.code == "no-slant"


def test_an_image_without_an_edge_is_refused() -> None:
    with pytest.raises(NotDeterminedError, match="no edge") as refused:
        find_edge(default_rng().normal(100, 1, SHAPE))
    assert refused.value.code == "no-edge"


def test_too_few_rows_are_refused() -> None:
    with pytest.raises(NotDeterminedError, match="more rows") as refused:
        slanted_edge(edge_image(CORNER, PITCH_UM, (14, 60), SLANT), PITCH_UM)
    assert refused.value.code == "edge-too-short"


@pytest.mark.parametrize("n_columns", [36, 34, 32, 30])
@pytest.mark.parametrize("slant", [SLANT, -SLANT])
def test_an_edge_that_leaves_the_image_is_refused(n_columns: int, slant: float) -> None:
    image = edge_image(CORNER, PITCH_UM, SHAPE, slant)[:, :n_columns]  # it runs from 20 to 39
    with pytest.raises(NotDeterminedError, match="cut the image") as refused:
        slanted_edge(image, PITCH_UM)
    assert refused.value.code == "edge-at-border"
