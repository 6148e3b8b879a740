"""From a recording to its system gain, its read noise and its data sheet."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


def photon_transfer(request: Mapping[str, Any], tell: Callable[[float], None]) -> dict[str, Any]:
    """Reduce `recording_path` by `method`; return the command's answer.

    Leaves the data sheet where there is one, or the maps of the methods that have them.
    """
    from calib.recording.open import open_recording  # noqa: PLC0415
    from service.api.jobs.kinds.answer_file import write_answer  # noqa: PLC0415
    from service.evaluation.photon_transfer import determine, write_sheet  # noqa: PLC0415

    files = Path(request["files"])
    found = determine(
        open_recording(Path(request["recording_path"])),
        request["method"],
        maps=False,
        progress=lambda share, _doing: tell(share),
    )
    if found.sensor is not None and found.sensor.sheet is not None:
        names = ("report.html", "data-sheet.json", "data-sheet.xml")
        write_sheet(found.sensor.sheet, *(files / name for name in names))
    if found.pair is not None:
        found.pair.save(files / "maps.h5")
    return write_answer(files, found.answer())
