"""Area sensors of four quadrants and blocks of few frames: statistics are as chance has them."""

from pathlib import Path

import numpy as np
import pytest

from calib.diagnosis.baseline.requirements import check_can_be_diagnosed
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.fitted_evidence import evidence_of
from calib.diagnosis.naming.look import Look
from calib.diagnosis.recorded.conditions_table import conditions_table
from calib.diagnosis.recorded.limits import limits
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.few_samples import (
    excess_as_normal,
    lagged_covariance,
    lagged_variance,
)
from calib.diagnosis.statistics.gather import gather
from calib.errors import NotDeterminedError
from calib.recording.folder_recording import FolderRecording

ROWS, COLUMNS, GAIN, READ_DN, DARK_DN = 48, 96, 0.4, 4.0, 3600.0
CONDITIONS = "block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"


def quadrants(folder: Path, seed: int, n_frames: int) -> FolderRecording:
    """Write a flat and a dark of a clean sensor of four taps, drawn with NumPy alone."""
    rng = np.random.default_rng(seed)
    (folder / "frames").mkdir(parents=True)
    tap_gain = np.kron(np.array([[1.0, 1.02], [0.99, 1.01]]), np.ones((ROWS // 2, COLUMNS // 2)))
    light = 20_000.0 * (1.0 + 0.3 * np.linspace(-1.0, 1.0, COLUMNS)) * np.ones((ROWS, 1))
    for name, mean in (("flat", light), ("dark", 0.0 * light)):
        electrons = rng.poisson(mean, (n_frames, ROWS, COLUMNS))
        dn = GAIN * tap_gain * electrons + DARK_DN + READ_DN * rng.standard_normal(electrons.shape)
        np.save(folder / "frames" / f"{name}.npy", np.round(dn).astype(np.uint16))
    (folder / "recording.toml").write_text(
        f"[camera]\ncolumns = {COLUMNS}\nrows = {ROWS}\nbit_depth = 16\ntaps = 4\n"
        'tap_layout = "quadrants"\n'
    )
    rows = [f"flat,flat,2000,1,,,{n_frames},", f"dark,dark,2000,0,,,{n_frames},"]
    (folder / "conditions.csv").write_text("\n".join([CONDITIONS, *rows]) + "\n")
    return FolderRecording(folder)


def evidence(recording: FolderRecording) -> Evidence:
    sums = gather(recording)
    table = conditions_table(recording.header, [each.n_lines for each in sums])
    return evidence_of(sums, table, Sensor(recording.header.camera))


@pytest.mark.parametrize("n_frames", [2, 4, 10])
def test_statistics_of_few_frames_of_quadrants_scatter_as_expected(
    tmp_path: Path, n_frames: int
) -> None:
    z: dict[str, list[float]] = {}
    for seed in range(8):
        found = evidence(quadrants(tmp_path / str(seed), seed, n_frames))
        # By chance alone: what few events may add to fourth moments is allowed for besides.
        std = np.stack([each.vector() for _, each in found.pooled.expected])
        used = np.isfinite(std) & (std > 0)
        white = found.observed().pooled / np.where(used, std, 1.0)
        for kind, where in found.pooled.places.items():
            z.setdefault(kind, []).extend(white[:, where][used[:, where]].tolist())
        assert len(found.sensor.noisy) == 0
    for kind, values in z.items():
        if not values:
            continue
        # Gain and read noise are fitted to the variances: of 16 numbers 8 are free.
        free = len(values) * (0.5 if kind == "variance" else 1.0)
        scale = np.sqrt(np.sum(np.square(values)) / free)
        assert abs(scale - 1.0) < 4.0 / np.sqrt(2.0 * free), (kind, scale)
        assert abs(np.mean(values)) < 4.0 / np.sqrt(len(values)), kind


def test_every_tap_s_gain_comes_out(tmp_path: Path) -> None:
    gains = np.stack(
        [evidence(quadrants(tmp_path / str(s), s, 4)).baseline.gain_dn_per_e for s in range(8)]
    )
    std = GAIN * np.sqrt(2.0 / (3 * ROWS * COLUMNS / 4 * len(gains)))
    assert np.all(np.abs(gains.mean(axis=0) - GAIN * np.array([1.0, 1.02, 0.99, 1.01])) < 4 * std)


@pytest.mark.parametrize("freedom", [2, 6, 30])
def test_variances_of_few_samples_become_normal_numbers(freedom: int) -> None:
    chi2 = np.random.default_rng(freedom).chisquare(freedom, 200_000)
    z = excess_as_normal(chi2 / freedom, freedom) * np.sqrt(freedom / 2)
    # The cube root leaves a skewness of some hundredths at two degrees of freedom.
    assert abs(z.mean()) < 0.02
    assert abs(z.std() - 1.0) < 0.03
    assert (z > 6.0).sum() == 0
    assert ((chi2 / freedom - 1.0) * np.sqrt(freedom / 2) > 6.0).sum() > 0 or freedom > 6


def test_one_signal_is_told_in_one_sentence_with_the_blocks_to_add(tmp_path: Path) -> None:
    header = quadrants(tmp_path / "one", 0, 2).header
    check_can_be_diagnosed(header)
    one, few = limits(header)
    assert "cannot be known" in one
    assert "add flats of 250, 500, 1000, 3000 us, and darks at two exposures" in one
    assert one.count(".") == 1
    assert "8 frames or more" in few


def test_a_look_at_nothing_is_as_chance_has_it() -> None:
    # Of a flat and a dark each pixel's offset and slope take both means.
    nothing = Look("mean", ("column",), 3e-55, 0.0, np.zeros(2))
    assert nothing.sigma(0.0, 25) == 0.0


def test_single_frames_are_refused(tmp_path: Path) -> None:
    header = quadrants(tmp_path / "single", 0, 2).header
    blocks = tuple(b.model_copy(update={"lines": 1}) for b in header.blocks)
    with pytest.raises(NotDeterminedError, match="2 frames or more"):
        check_can_be_diagnosed(header.model_copy(update={"blocks": blocks}))


@pytest.mark.parametrize(("n", "lag"), [(3, 1), (4, 1), (4, 2), (10, 1), (10, 2), (63, 2)])
def test_covariances_of_few_lines_scatter_as_the_quadratic_form_has_it(n: int, lag: int) -> None:
    lines = np.random.default_rng(n).standard_normal((40_000, n))
    centred = lines - lines.mean(axis=1, keepdims=True)
    found = lagged_covariance(centred, lag)
    # Residuals about the mean of n lines covary by -1/n.
    assert abs(found.mean() + 1.0 / n) < 4.0 * found.std() / np.sqrt(len(found))
    # The variance of a variance, by the fourth moments that were drawn.
    spread = np.sqrt(np.var((found - found.mean()) ** 2) / len(found))
    assert abs(found.var() - lagged_variance(n, lag)) < 4.0 * spread
