"""`darkflat photon-transfer`: system gain, read noise, EMVA 1288; S3NUC and SANUC."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress


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
        from service.evaluation.photon_transfer import (  # noqa: PLC0415
            determine,
            sheet_of,
            write_sheet,
        )

        for each in (out, data_sheet):
            if each is not None:
                refuse_existing(each)
        check_report(report)
        opened = open_recording(recording)
        with about(recording), progress("Photon transfer") as tell:
            found = determine(opened, method.value, maps=out is not None, progress=tell)
            if found.sensor is not None and (report or data_sheet):
                write_sheet(sheet_of(found.sensor), *filter(None, (data_sheet, report)))
            if found.pair is not None and out is not None:
                found.pair.save(out)
        written = {"report": report, "data_sheet": data_sheet, "maps": out}
        told = {**found.answer(), "written": written}
        answer.give(told, lambda console: _show(console, told))


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
