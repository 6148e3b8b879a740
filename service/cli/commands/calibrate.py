"""`darkflat calibrate`: from a recording to a coefficient set."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.progress import progress, share_of

if TYPE_CHECKING:
    from rich.console import Console


def calibrate(
    recording: Annotated[Path, typer.Argument(metavar="REC", help="An .h5 or a recording folder")],
    *,
    out: Annotated[Path, typer.Option(metavar="SET.h5", help="The coefficient set to write")],
    radiances: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="level,radiance; goes before what blocks state"),
    ] = None,
    relative: Annotated[bool, typer.Option("--relative", help="Do without radiances")] = False,
    no_darks: Annotated[bool, typer.Option("--no-darks", help="Do without capped darks")] = False,
    order: Annotated[
        int | None, typer.Option(min=2, max=20, help="Of the vignette; chosen where not given")
    ] = None,
    tone: Annotated[
        tuple[float, float] | None,
        typer.Option(
            metavar="CYCLES PIXELS",
            help="A known synchronous tone to remove: cycles per pixel clock, clocks per line",
        ),
    ] = None,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="Figures to judge it by")
    ] = None,
    store: Annotated[bool, typer.Option("--store", help="Add it to the store, as a draft")] = False,
    json: Json = None,
) -> None:
    """Determine DN0, VE and QE of every column, with their uncertainty (AgCam)."""
    with answering(json) as answer:
        from calib.radiometric.calibrate import calibrate as determine  # noqa: PLC0415
        from calib.recording.open import open_recording  # noqa: PLC0415
        from calib.recording.tone import Tone  # noqa: PLC0415
        from service.cli.radiance_csv import read_radiances  # noqa: PLC0415
        from service.cli.set_output import save_set  # noqa: PLC0415

        opened = open_recording(recording)
        known_tone = Tone(*tone) if tone else None
        with progress("Calibrating") as tell:
            calibration = determine(
                opened,
                radiances=read_radiances(radiances) if radiances else None,
                tone=known_tone,
                order=order,
                relative=relative,
                darks_required=not no_darks,
                progress=share_of(tell, "statistics of every column"),
            )
        save_set(calibration.coefficients, out)
        told: dict[str, Any] = {**calibration.answer(), "path": str(out), "report": None}
        if report is not None:
            from service.cli.reporting import write_calibration_report  # noqa: PLC0415

            write_calibration_report(report, opened, calibration, known_tone)
            told["report"] = str(report)
        if store:
            from service.cli.opened_store import opened_store, who  # noqa: PLC0415

            with opened_store() as sets:
                sets.sets.add(calibration.coefficients, by=who())
        answer.give(told, lambda console: show_calibration(console, told))


def show_calibration(console: "Console", told: dict[str, Any]) -> None:
    """Print what a bench operator asks first."""
    from service.cli.tables import facts, number, with_std  # noqa: PLC0415

    at_axis = told["responsivity_at_axis"]
    dark = told["mean_dark_offset_dn"]
    facts(
        console,
        {
            "coefficient set": told["coefficient_set"],
            "columns": f"{told['valid_columns']} of {told['columns']} valid",
            "dark offset": f"{number(dark['regression'])} DN by regression,"
            f" {number(dark['capped'])} DN capped",
            "vignette": f"order {told['vignette_order']},"
            f" axis at column {with_std(told['axis_column'], told['axis_column_std'])},"
            f" {number(told['edge_fall_percent'])} % fall at the edge",
            "responsivity": f"{with_std(at_axis['value'], at_axis['std'])} {at_axis['unit']}",
            "scatter along the line": f"{number(told['cov_before_percent'])} % before,"
            f" {number(told['cov_after_percent'])} % after",
            "reduced χ²": number(told["reduced_chi_squared"]),
        },
    )
    for warning in told["warnings"]:
        console.print(f"! {warning}", markup=False)
