"""Writing a sensor's data sheet for people and for programs."""

from pathlib import Path

from calib.errors import NotDeterminedError
from calib.recording.durable import write_whole
from calib.transfer.characterisation import Characterisation
from calib.transfer.emva1288.machine_readable import to_json, to_xml
from calib.transfer.emva1288.report.page import write_page


def write_sheet(found: Characterisation, report: Path | None, data_sheet: Path | None) -> None:
    """Write the page and the machine-readable sheet, as far as they are asked for.

    Raises:
        NotDeterminedError: `no-data-sheet`: the recording determines none.
    """
    if found.sheet is None:
        msg = f"there is no data sheet to write: {found.no_sheet_because}"
        raise NotDeterminedError(msg, code="no-data-sheet")
    if data_sheet is not None:
        text = (to_xml if data_sheet.suffix == ".xml" else to_json)(found.sheet)
        write_whole(data_sheet, text.encode("utf-8"))
    if report is not None:
        write_page(report, found.sheet)
