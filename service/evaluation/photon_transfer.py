"""Photon transfer by one of its methods, with the maps and the data sheets that it gives."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from calib.errors import NotDeterminedError
from calib.recording.durable import write_whole
from calib.recording.protocol import Recording
from calib.transfer.characterisation import Characterisation, characterise
from calib.transfer.emva1288.machine_readable import to_json, to_xml
from calib.transfer.emva1288.report.page import write_page
from calib.transfer.emva1288.sheet import DataSheet
from calib.transfer.two_exposures.two_exposures import TwoExposures, two_exposure_moments

Method = Literal["ptc", "sanuc", "s3nuc"]
Doing = Callable[[float, str], None]


@dataclass(frozen=True)
class Determined:
    """What a recording's frames say of its sensor.

    Attributes:
        sensor: The curve and EMVA's figures, by `ptc`.
        pair: Maps from two exposures of one scene, by the others, or beside `ptc`.
    """

    sensor: Characterisation | None
    pair: TwoExposures | None

    def answer(self) -> dict[str, Any]:
        """Return the method's own answer; that of maps beside the curve is in it."""
        beside = None if self.pair is None else self.pair.answer()
        if self.sensor is None:
            return beside or {}
        return {**self.sensor.answer(), "two_exposures": beside}


def determine(recording: Recording, method: Method, *, maps: bool, progress: Doing) -> Determined:
    """Find system gain and read noise.

    Args:
        recording: Flats and darks; two exposures of one scene for maps.
        method: The whole curve, or two exposures.
        maps: Whether they are wanted beside `ptc`.
        progress: Called with the share that is done, 0 to 1, and what goes on.

    Raises:
        NotDeterminedError: The recording does not allow it; its code says why.
    """
    sensor = pair = None
    if method == "ptc":
        sensor = characterise(recording, progress=lambda s: progress(s, "curve and data sheet"))
    if maps or method != "ptc":
        pair = two_exposure_moments(
            recording,
            "s3nuc" if method == "s3nuc" else "sanuc",
            progress=lambda share: progress(share, "moments of every pixel"),
        )
    return Determined(sensor, pair)


def sheet_of(found: Characterisation) -> DataSheet:
    """Return EMVA's data sheet; NotDeterminedError `no-data-sheet` where there is none."""
    if found.sheet is None:
        msg = f"there is no data sheet to write: {found.no_sheet_because}"
        raise NotDeterminedError(msg, code="no-data-sheet")
    return found.sheet


def write_sheet(sheet: DataSheet, *paths: Path) -> None:
    """Write a data sheet as a page (.html) and for programs (.json, .xml): by the names' ends."""
    for path in paths:
        if path.suffix == ".html":
            write_page(path, sheet)
        else:
            text = (to_xml if path.suffix == ".xml" else to_json)(sheet)
            write_whole(path, text.encode("utf-8"))
