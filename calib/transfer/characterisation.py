"""Photon transfer and EMVA 1288 of one recording, told together.

Gain and read noise are those of the photon-transfer fit, whose model may bend; every other figure
is EMVA's, whose own straight-line gain and noise stand under `emva1288`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from calib.errors import NotDeterminedError
from calib.recording.protocol import Recording
from calib.recording.statistics import Progress, never
from calib.transfer.emva1288.catalogue import CATALOGUE
from calib.transfer.emva1288.data_sheet import data_sheet
from calib.transfer.emva1288.sheet import DataSheet
from calib.transfer.estimate import Estimate
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.result import PhotonTransfer


@dataclass(frozen=True)
class Characterisation:
    """What a recording of darks and flats says of a sensor.

    Attributes:
        transfer: The photon-transfer fit.
        sheet: EMVA's figures; None where the recording does not determine them.
        no_sheet_because: Why not, one sentence; "" where there is a sheet.
    """

    transfer: PhotonTransfer
    sheet: DataSheet | None
    no_sheet_because: str

    def answer(self) -> dict[str, Any]:
        """Return what `darkflat photon-transfer --json` prints."""
        fitted = self.transfer.answer()
        if self.sheet is None:
            figures = {
                figure.name: Estimate.unknown(figure.unit, self.no_sheet_because).answer()
                for figure in CATALOGUE
            }
            return {**figures, **fitted, "emva1288": None}
        sheet = self.sheet.answer()
        warnings = dict.fromkeys((*fitted["warnings"], *sheet["warnings"]))
        return {**sheet, **fitted, "warnings": list(warnings), "emva1288": sheet}


def characterise(
    recording: Recording,
    *,
    progress: Progress | None = None,
    cancelled: Callable[[], bool] = never,
) -> Characterisation:
    """Fit the photon-transfer curve, then work out EMVA's figures; the frames are read twice.

    Args:
        recording: Flats of several exposures or levels, and capped darks; from frames or from
            what `statistics.csv` kept.
        progress: Called with the share that is done, 0 to 1.
        cancelled: Asked before each stretch of frames; True ends in CancelledError.

    Raises:
        NotDeterminedError: `no-temporal-noise`, `photon-transfer-range`.
    """

    def half(which: int) -> Progress | None:
        return (lambda share: progress((which + share) / 2.0)) if progress else None

    transfer = photon_transfer(recording, progress=half(0), cancelled=cancelled)
    try:
        sheet = data_sheet(recording, progress=half(1), cancelled=cancelled)
    except NotDeterminedError as error:
        return Characterisation(transfer, None, str(error))
    return Characterisation(transfer, sheet, "")
