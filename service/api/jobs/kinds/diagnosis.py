"""From one recording, or several of one bench, to what the plain model lacks."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


def diagnose(request: Mapping[str, Any], tell: Callable[[float], None]) -> dict[str, Any]:
    """Diagnose `recording_paths`; return the command's answer, leave its page and its model."""
    from calib.forward.model import Model  # noqa: PLC0415
    from calib.recording.open import open_recording  # noqa: PLC0415
    from service.api.jobs.kinds.answer_file import write_answer  # noqa: PLC0415
    from service.evaluation.diagnosis import take_diagnosis  # noqa: PLC0415

    files = Path(request["files"])
    diagnosis = take_diagnosis(
        [open_recording(Path(each)) for each in request["recording_paths"]],
        None if request["model"] is None else Model.loads(request["model"]),
        title=f"Diagnosis of {' and '.join(request['names'])}",
        report=files / "report.html",
        model_out=files / "amended-model.toml",
        progress=tell,
    )
    return write_answer(files, diagnosis.answer())
