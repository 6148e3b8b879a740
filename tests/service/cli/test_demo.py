"""`demo`, without Aravis: the rest is the same; over GigE Vision it is marked."""

import html
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.forward.model import Model
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.open import open_recording
from calib.recording.protocol import Recording
from service.bench import BenchSettings
from service.cli.demo_diagnosis import take_diagnosis
from service.cli.demonstration import HIDDEN
from service.cli.simulated_bench import ChosenBench, simulated_bench
from service.doctor.aravis import why_no_aravis
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]

KEYS = {
    "transport", "serial", "frames", "lost_frames", "recording", "coefficient_set",
    "cov_before_percent", "cov_after_percent", "diagnosis", "report", "seconds",
}  # fmt: skip


def quick(chosen: ChosenBench) -> ChosenBench:
    """Leave slow lines and waits out, under a name of its own: another demo may run meanwhile."""
    mocks = {
        "id": f"demo-{os.getpid()}",
        "camera": {"driver": "mock", "paced": False},
        "light": {"driver": "mock"},
        "monitor": {"driver": "mock", "integration_s": 0.001},
        "shutter": {"driver": "mock"},
    }
    content = {**chosen.settings.model_dump(), **mocks}
    return ChosenBench(BenchSettings.parse(content), chosen.remark)


def check(ran: Ran, out: Path) -> None:
    assert ran.status == 0, ran.stderr
    told = ran.json
    assert set(told) >= KEYS
    assert told["cov_after_percent"] < 0.3 * told["cov_before_percent"]
    recording = open_recording(told["recording"])
    assert sum(block.lines or 0 for block in recording.header.blocks) == 128 * told["frames"]
    assert CoefficientSet.load(out / "coefficient-set.h5").id == told["coefficient_set"]
    assert Path(told["report"]).stat().st_size > 10_000
    check_diagnosis(told, out)


def check_diagnosis(told: dict[str, Any], out: Path) -> None:
    """Check that what the bench hides is found, and said on both pages."""
    first = told["diagnosis"]["findings"][0]
    assert first["effect"] == HIDDEN.name
    coupling = first["parameters"]["column_coupling"]
    # Signatures of a few drawn lines scatter by a few per cent of their own.
    allowed = 5.0 * math.hypot(coupling["std"], 0.02 * HIDDEN.column_coupling)
    assert abs(coupling["value"] - HIDDEN.column_coupling) < allowed
    for page in (told["report"], told["diagnosis"]["report"]):
        assert first["sentence"] in html.unescape(Path(page).read_text(encoding="utf-8"))
    assert Model.load(out / "amended-model.toml").effect(HIDDEN.name) is not None


def test_without_aravis_the_demo_runs_in_process_and_says_why(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.cli.simulated_bench.why_no_aravis", lambda: "it is not there")
    chosen = simulated_bench(seed=5)
    monkeypatch.setattr("service.cli.simulated_bench.simulated_bench", lambda **_: quick(chosen))
    diagnoses: list[Diagnosis] = []

    def taken(recording: Recording, out: Path) -> Diagnosis:
        diagnoses.append(take_diagnosis(recording, out))
        return diagnoses[-1]

    monkeypatch.setattr("service.cli.demonstration.take_diagnosis", taken)
    ran = run("demo", "--out", tmp_path / "demo", "--json", "-")
    check(ran, tmp_path / "demo")
    assert (ran.json["transport"], ran.json["serial"]) == ("in-process", "in-process")
    assert "it is not there" in ran.json["remark"]
    kept = diagnoses[0]
    monkeypatch.setattr("service.cli.demonstration.take_diagnosis", lambda *_: kept)
    again = run("demo", "--out", tmp_path / "demo", "--json", "-")
    assert again.status == 0, again.stderr
    assert again.json["frames"] == ran.json["frames"]


@pytest.mark.aravis
@pytest.mark.soak  # 40 s of lamps and slow lines
def test_the_demo_goes_over_gige_vision(run: Run, tmp_path: Path) -> None:
    assert why_no_aravis() == ""
    ran = run("demo", "--out", tmp_path / "demo", "--json", "-")
    check(ran, tmp_path / "demo")
    assert (ran.json["transport"], ran.json["lost_frames"]) == ("gige-vision", 0)
    assert ran.json["serial"] == "pseudo-terminal"


def test_the_demo_touches_no_folder_of_somebody_else(run: Run, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("do not delete")
    ran = run("demo", "--out", tmp_path, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert (tmp_path / "thesis.txt").exists()
