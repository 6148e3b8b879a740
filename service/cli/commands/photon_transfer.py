"""`darkflat photon-transfer`: system gain, read noise, EMVA 1288; S3NUC and SANUC."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from calib.recording.protocol import Recording
    from calib.transfer.characterisation import Characterisation
    from calib.transfer.two_exposures.two_exposures import TwoExposures


class Method(StrEnum):
    """How gain and noise are found."""

    PTC = "ptc"
    SANUC = "sanuc"
    S3NUC = "s3nuc"


def photon_transfer(
    recording: Annotated[Path, path_argument(metavar="REC", help="An .h5 or a recording folder")],
    *,
    method: Annotated[
        Method, typer.Option(help="The whole curve, or two exposures of one scene")
    ] = Method.PTC,
    out: Annotated[
        Path | None,
        path_option(metavar="MAPS.h5", help="Per pixel, from two exposures; SANUC's unless s3nuc"),
    ] = None,
    report: Annotated[
        Path | None, path_option(metavar="FILE.html", help="EMVA 1288 data sheet (ptc)")
    ] = None,
    data_sheet: Annotated[
        Path | None, path_option(metavar="FILE", help="The same for programs: .json or .xml (ptc)")
    ] = None,
    json: Json = None,
) -> None:
    """Determine system gain, read noise and EMVA 1288's figures from frames alone."""
    if method is not Method.PTC and (report or data_sheet):
        raise typer.BadParameter("a data sheet comes from --method ptc", param_hint="--report")
    if data_sheet is not None and data_sheet.suffix not in {".json", ".xml"}:
        raise typer.BadParameter("name a .json or an .xml file", param_hint="--data-sheet")
    with answering(json) as answer:
        from calib.recording.durable import refuse_existing  # noqa: PLC0415
        from calib.recording.open import open_recording  # noqa: PLC0415
        from service.cli.about import about  # noqa: PLC0415
        from service.cli.set_output import check_report  # noqa: PLC0415

        for each in (out, data_sheet):
            if each is not None:
                refuse_existing(each)
        check_report(report)
        opened = open_recording(recording)
        with about(recording), progress("Photon transfer") as tell:
            sensor = pair = None
            if method is Method.PTC:
                from calib.transfer.characterisation import characterise  # noqa: PLC0415

                sensor = characterise(opened, progress=share_of(tell, "curve and data sheet"))
            if out is not None or method is not Method.PTC:
                pair = _pair(opened, method, share_of(tell, "moments of every pixel"))
            if sensor is not None and (report or data_sheet):
                from service.cli.data_sheet_files import write_sheet  # noqa: PLC0415

                write_sheet(sensor, report, data_sheet)
            if pair is not None and out is not None:
                pair.save(out)
        told = _told(sensor, pair, report=report, data_sheet=data_sheet, maps=out)
        answer.give(told, lambda console: _show(console, told))


def _pair(opened: "Recording", method: Method, tell: "Callable[[float], None]") -> "TwoExposures":
    """Reduce two exposures of one scene."""
    from calib.transfer.two_exposures.two_exposures import two_exposure_moments  # noqa: PLC0415

    name: Literal["sanuc", "s3nuc"] = "s3nuc" if method is Method.S3NUC else "sanuc"
    return two_exposure_moments(opened, name, progress=tell)


def _told(
    sensor: "Characterisation | None", pair: "TwoExposures | None", **files: Path | None
) -> dict[str, Any]:
    """Return the answer: the method's own, that of the maps beside it, and what was written."""
    written = {name: str(path) if path else None for name, path in files.items()}
    if sensor is None:
        assert pair is not None  # noqa: S101 - one of the two was asked for
        return {**pair.answer(), "written": written}
    beside = None if pair is None else pair.answer()
    return {**sensor.answer(), "two_exposures": beside, "written": written}


def _show(console: Any, told: dict[str, Any]) -> None:
    """Print what a person asks first."""
    from service.cli.tables import facts, with_std  # noqa: PLC0415

    shown = {
        "system gain": "system_gain_dn_per_e",
        "read noise": "read_noise_e",
        "bias": "bias_dn",
        "photo-electrons": "photoelectrons",
        "saturation capacity": "saturation_capacity_e",
        "dynamic range": "dynamic_range_db",
        "linearity error": "linearity_error_percent",
        "DSNU": "dsnu_e",
        "PRNU": "prnu_percent",
    }
    rows = {
        title: f"{with_std(told[name]['value'], told[name]['std'])} {told[name]['unit']}"
        for title, name in shown.items()
        if name in told
    }
    facts(console, {"method": told["method"], **rows})
    for warning in told["warnings"]:
        console.print(f"! {warning}", markup=False)
