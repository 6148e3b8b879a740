"""`darkflat mtf`: contract §6, and that nothing half-written is left."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.random import default_rng

from calib.mtf.geometry import Alignment
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.edge import edge_image
from calib.mtf.simulation.folder import write_folder
from calib.mtf.simulation.response import centred
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from tests.calib.mtf.simulated import CORNER, ORDERS_12, SMALL, record
from tests.calib.radiometric.example_set import example_set
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]
SHIFT_UM = np.array([11.0, -23.0])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    case = record(
        default_rng(), (40, 40), scan=SMALL, grating=ORDERS_12, alignment=Alignment(SHIFT_UM),
        detector=DetectorNoise(shot_noise=True, averaged=100),
    )  # fmt: skip
    return write_folder(tmp_path / "scan", SMALL, ORDERS_12, case.scan.images)


def test_the_answer_and_the_file_are_those_of_the_contract(
    run: Run, folder: Path, tmp_path: Path
) -> None:
    out = tmp_path / "TF.h5"
    told = run("mtf", folder, "--out", out, "--json", "-").json
    x, y = CORNER.centroid_um
    cos, sin = np.cos(SMALL.tilt_rad), np.sin(SMALL.tilt_rad)
    shift = SHIFT_UM + np.array([cos * x - sin * y, sin * x + cos * y])
    away = ORDERS_12.harmonics.shortest(np.array(told["grating_shift_um"]) - shift)
    assert np.abs(away / told["grating_shift_std_um"]).max() < 5
    assert told["first_zero_per_mm"] == [None, None]  # beyond 41.6/mm, where the pattern ends
    nyquist = centred(CORNER, np.array([0.02, 0.0]), np.array([0.0, 0.02]))
    for axis, true in zip("xy", np.abs(nyquist), strict=True):
        assert abs(told["mtf_at_nyquist"][axis] - true) < 5 * told["mtf_at_nyquist"]["std"]
    with h5py.File(out) as file:
        assert file.attrs["id"] == told["transfer_function"]
        axis = file["frequency_per_mm"][()]
        valid, transfer, std = (file[name][()] for name in ("valid", "transfer", "transfer_std"))
        assert transfer.shape == valid.shape == std.shape == (len(axis), len(axis))
        middle = len(axis) // 2
        assert axis[middle] == 0
        assert transfer[middle, middle] == pytest.approx(1.0, abs=1e-6)
        fy, fx = np.meshgrid(axis / 1e3, axis / 1e3, indexing="ij")
        error = np.abs(transfer - centred(CORNER, fx, fy))[valid]
        assert (error < 4 * std[valid] + 1e-9).mean() > 0.97
        assert told["mean_transfer_std"] == pytest.approx(std[valid].mean())
        assert np.isnan(transfer[~valid]).all()
        psf, at = file["psf"][()], file["position_um"][()]
        assert psf.sum() * (at[1] - at[0]) ** 2 == pytest.approx(1.0, abs=1e-3)


def test_the_paper_s_filter_answers_the_same_keys_and_says_what_it_misses(
    run: Run, folder: Path, tmp_path: Path
) -> None:
    answers = [
        run(
            "mtf", folder, "--out", tmp_path / f"{method}.h5", "--method", method, "--json", "-"
        ).json
        for method in ("regularised", "filter")
    ]
    assert set(answers[0]) == set(answers[1])
    assert answers[1]["method"] == "filter"
    assert any("smooths" in warning for warning in answers[1]["warnings"])
    assert answers[0]["grating_shift_um"] == answers[1]["grating_shift_um"]


def test_a_report_needs_nothing_but_itself(run: Run, folder: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    ran = run("mtf", folder, "--out", tmp_path / "TF.h5", "--report", report)
    assert ran.status == 0
    assert "MTF at Nyquist, x" in ran.stdout
    text = report.read_text("utf-8")
    assert text.count("<svg") == 5
    assert "http" not in text.replace("http://www.w3.org", "").replace(
        "http://purl.org", ""
    ).replace("https://matplotlib.org", "").replace("http://creativecommons.org", "")


def test_a_set_carries_it_under_a_new_id(run: Run, folder: Path, tmp_path: Path) -> None:
    before = example_set(8)
    before.save(tmp_path / "set.h5")
    told = run(
        "mtf", folder, "--out", tmp_path / "TF.h5", "--set", tmp_path / "set.h5",
        "--set-out", tmp_path / "new.h5", "--json", "-",
    ).json  # fmt: skip
    made = CoefficientSet.load(tmp_path / "new.h5")
    assert made.id == told["coefficient_set"] != before.id
    assert made.transfer_function is not None
    assert made.transfer_function.id == told["transfer_function"]
    assert made.transfer_function.mtf_at_nyquist == (
        told["mtf_at_nyquist"]["x"],
        told["mtf_at_nyquist"]["y"],
    )
    assert CoefficientSet.load(tmp_path / "set.h5").id == before.id


@pytest.mark.parametrize("direction", ["x", "y"])
def test_an_edge_answers_in_its_direction(run: Run, tmp_path: Path, direction: str) -> None:
    image = edge_image(CORNER, 25.0, (200, 60), 0.0933)
    (tmp_path / "edge" / "frames").mkdir(parents=True)
    np.save(tmp_path / "edge/frames/000.npy", image if direction == "x" else image.T)
    (tmp_path / "edge/mtf.toml").write_text(f'pitch_um = 25.0\n[edge]\ndirection = "{direction}"\n')
    told = run("mtf", tmp_path / "edge", "--out", tmp_path / "TF.h5", "--json", "-").json
    at, other = (0, "y") if direction == "x" else (1, "x")
    assert told["first_zero_per_mm"][at] == pytest.approx(42.8, abs=1.0)
    assert told["mtf_at_nyquist"][other] is None
    refused = run(
        "mtf", tmp_path / "edge", "--out", tmp_path / "x.h5", "--report", tmp_path / "r.html",
        "--json", "-",
    )  # fmt: skip
    assert (refused.status, refused.error_code) == (1, "edge-only")


@pytest.mark.parametrize(
    ("damage", "code"),
    [
        (lambda folder: (folder / "frames/003.npy").unlink(), "frames-missing"),
        (lambda folder: (folder / "mtf.toml").unlink(), "not-found"),
        (
            lambda folder: [
                np.save(path, default_rng().normal(1e4, 100, (40, 40)))
                for path in (folder / "frames").iterdir()
            ],
            "no-pattern",
        ),
    ],
)
def test_what_cannot_be_used_ends_in_one_sentence_and_no_file(
    run: Run, folder: Path, tmp_path: Path, damage: Callable[[Path], object], code: str
) -> None:
    damage(folder)
    ran = run(
        "mtf", folder, "--out", tmp_path / "TF.h5", "--report", tmp_path / "r.html", "--json", "-"
    )
    assert (ran.status, ran.error_code) == (1, code)
    assert len(ran.stderr.strip().splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scan"]


def test_an_output_that_is_there_is_never_overwritten(
    run: Run, folder: Path, tmp_path: Path
) -> None:
    (tmp_path / "TF.h5").write_text("mine")
    ran = run("mtf", folder, "--out", tmp_path / "TF.h5", "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert (tmp_path / "TF.h5").read_text() == "mine"


@pytest.mark.parametrize("more", [("--support", "4"), ("--set", "set.h5"), ("--method", "guess")])
def test_wrong_usage_is_status_2(run: Run, more: tuple[str, ...]) -> None:
    assert run("mtf", "scan", "--out", "TF.h5", *more).status == 2
