"""A diagnosis with its page and its amended model."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from calib.diagnosis.answer.amended import amended_model
from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.deciding.decide import decided
from calib.diagnosis.diagnose import Examination, diagnose
from calib.diagnosis.recorded.joint import joint
from calib.diagnosis.report.page import save_page, save_page_of_undiagnosed
from calib.diagnosis.sums.amended import amended_model as amended_by_sums
from calib.diagnosis.sums.diagnose import diagnose_sums
from calib.errors import NotDeterminedError
from calib.forward.model import Model
from calib.recording.folder_recording import FolderRecording
from calib.recording.protocol import Recording

Progress = Callable[[float], None]
_Examined = tuple[Diagnosis, Examination | None, Callable[[], Model]]


def take_diagnosis(
    recordings: Sequence[Recording],
    given: Model | None,
    *,
    title: str,
    report: Path | None,
    model_out: Path | None,
    progress: Progress,
) -> Diagnosis:
    """Diagnose recordings of one bench; write the page and the amended model where asked for.

    Args:
        recordings: At least one.
        given: What the sensor should be; None for the plain model.
        title: Of the page.
        report: Where the page goes; one is written of what cannot be diagnosed, too.
        model_out: Where the amended model goes.
        progress: Called with the share that is done, 0 to 1.

    Raises:
        NotDeterminedError: The recordings do not allow it; its code says why.
    """
    try:
        diagnosis, examined, amended = _examined(recordings, given, progress)
    except NotDeterminedError as error:
        if report is not None:
            save_page_of_undiagnosed(error, report, title)
        raise
    if model_out is not None:
        amended().save(model_out)
    if report is not None:
        save_page(diagnosis, report, title, recordings[0].header.camera, examined)
    return diagnosis


def _examined(
    recordings: Sequence[Recording], given: Model | None, progress: Progress
) -> _Examined:
    """Return the diagnosis, what it rests on, and what makes the amended model.

    Sums have a way of their own, and nothing of the second.
    """
    first = recordings[0]
    if len(recordings) == 1 and isinstance(first, FolderRecording) and first.statistics:
        sums = diagnose_sums(first)
        return sums.diagnosis, None, partial(amended_by_sums, sums, given)
    whole = joint([each.header for each in recordings])
    found = decided(diagnose(recordings, given, progress=progress), whole)
    model = partial(amended_model, found.model, found.evidence, whole.header.source, given)
    return found.diagnosis, found, model
