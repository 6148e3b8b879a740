"""The demonstration's diagnosis: its page, its amended model, and what is told of it."""

from pathlib import Path
from typing import Any

from calib.diagnosis.answer.amended import amended_model
from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.report.page import save_page
from calib.recording.protocol import Recording


def take_diagnosis(recording: Recording, out: Path) -> Diagnosis:
    """Diagnose `recording`, and leave the page and the amended model in the folder `out`."""
    found = diagnose(recording)
    camera, source = recording.header.camera, recording.header.source
    save_page(found.diagnosis, out / "diagnosis.html", "Diagnosis of the demo", camera, found)
    amended_model(found.model, found.evidence, source).save(out / "amended-model.toml")
    return found.diagnosis


def sentences_of(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return what the calibration's report says of it."""
    return (diagnosis.summary, *(f"{f.sentence} {f.hid_as}" for f in diagnosis.findings))


def shortened(diagnosis: Diagnosis, out: Path) -> dict[str, Any]:
    """Return what the demonstration tells of its diagnosis; all of it is on the page."""
    told = diagnosis.answer()
    kept = ("effect", "probability", "significance_sigma", "sentence", "hid_as", "parameters")
    return {
        "verdict": told["verdict"],
        "summary": told["summary"],
        "findings": [{name: each[name] for name in kept} for each in told["findings"]],
        "unexplained": told["unexplained"],
        "next_measurement": told["next_measurement"],
        "report": str(out / "diagnosis.html"),
    }
