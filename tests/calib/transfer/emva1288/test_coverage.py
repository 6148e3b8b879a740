"""Stated standard uncertainties are what recordings drawn anew scatter by, figure by figure."""

import sys
from collections.abc import Callable, Mapping

import numpy as np
import pytest

from calib.transfer.emva1288.data_sheet import data_sheet
from tests.calib.transfer.emva1288.drawn_camera import DrawnCamera
from tests.calib.transfer.emva1288.plans import Bench, bench

AREA = DrawnCamera()
LINE = DrawnCamera(rows=None, columns=512, line_noise_dn=0.5)
Truth = Callable[[Bench], Mapping[str, float]]


def z_scores(
    camera: DrawnCamera, recordings: int, seed: int, truth: Truth, frames: int = 2
) -> dict[str, np.ndarray]:
    """Draw the camera's pattern and its recording anew each time."""
    rng = np.random.default_rng(seed)
    found: dict[str, list[float]] = {}
    for _ in range(recordings):
        drawn = bench(rng, camera)
        sheet = data_sheet(drawn.record(rng, frames, max(16, frames)))
        for name, value in truth(drawn).items():
            known = sheet[name]
            found.setdefault(name, []).append((known.value - value) / known.std)
    return {name: np.array(z) for name, z in found.items()}


def check(found: Mapping[str, np.ndarray], spread: float, sigmas: float = 4.0) -> None:
    """Mean 0 and spread 1, both within `spread` and `sigmas` of their own standard errors."""
    bad = []
    for name, z in found.items():
        assert np.all(np.isfinite(z)), name
        n = len(z)
        if abs(np.mean(z)) > spread + sigmas / np.sqrt(n):
            bad.append(f"{name}: mean {np.mean(z):.2f}")
        if abs(np.std(z, ddof=1) - 1.0) > spread + sigmas / np.sqrt(2 * n):
            bad.append(f"{name}: spread {np.std(z, ddof=1):.2f}")
    assert not bad, bad


def linearity(drawn: Bench) -> dict[str, float]:
    return {"linearity_error_percent": drawn.linearity_error()}


def test_an_area_sensors_figures_scatter_as_stated() -> None:
    check(z_scores(AREA, 120, 1, Bench.truth), spread=0.0)


def test_a_line_sensors_figures_scatter_as_stated() -> None:
    check(z_scores(LINE, 50, 2, Bench.truth, frames=40), spread=0.0)


def test_a_bent_responses_linearity_error_scatters_as_stated() -> None:
    check(z_scores(DrawnCamera(bend=0.05), 60, 3, linearity), spread=0.0)


@pytest.mark.soak
@pytest.mark.parametrize("seed", [11, 12, 13])
@pytest.mark.parametrize(
    ("camera", "truth", "frames"),
    [
        pytest.param(AREA, Bench.truth, 2, id="area"),
        pytest.param(LINE, Bench.truth, 40, id="line"),
        pytest.param(DrawnCamera(bend=0.05), linearity, 2, id="bent"),
    ],
)
def test_spreads_are_one_to_a_tenth(
    camera: DrawnCamera, truth: Truth, frames: int, seed: int
) -> None:
    check(z_scores(camera, 1000, seed, truth, frames), spread=0.1, sigmas=3.0)


@pytest.mark.soak
def test_print_the_table_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    kinds = {
        "area": z_scores(AREA, 600, 21, Bench.truth),
        "line": z_scores(LINE, 600, 22, Bench.truth, frames=40),
        "bent": z_scores(DrawnCamera(bend=0.05), 600, 23, linearity),
    }
    with capsys.disabled():
        for kind, found in kinds.items():
            for name, z in found.items():
                row = f"| {kind} | {name} | {np.mean(z):+.2f} | {np.std(z, ddof=1):.2f} |"
                sys.stdout.write(row + "\n")
    for found in kinds.values():
        check(found, spread=0.1)
