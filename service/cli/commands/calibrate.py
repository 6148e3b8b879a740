"""`darkflat calibrate`: from a recording to a coefficient set."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of
from service.cli.radiance_options import check_together

if TYPE_CHECKING:
    from rich.console import Console

    from calib.radiometric.calibration import Calibration
    from calib.recording.protocol import Recording
    from calib.recording.tone import Tone


def calibrate(
    recording: Annotated[Path, path_argument(metavar="REC", help="An .h5 or a recording folder")],
    *,
    out: Annotated[Path, path_option(metavar="SET.h5", help="The coefficient set to write")],
    radiances: Annotated[
        Path | None,
        path_option(metavar="FILE.csv", help="level,radiance; goes before what blocks state"),
    ] = None,
    lamp_spectra: Annotated[
        Path | None,
        path_option(
            metavar="LAMPS.csv",
            help="Compute radiances from the lamps' spectra, W m-2 sr-1 nm-1; with"
            " --spectral-response, instead of --radiances",
        ),
    ] = None,
    spectral_response: Annotated[
        Path | None,
        path_option(metavar="RESPONSE.csv", help="Of the camera; or the folder of its scan"),
    ] = None,
    certificate_std: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE",
            help="Of the lamps' spectra in common, k = 1; else as the recording states it",
        ),
    ] = None,
    response_correlation_nm: Annotated[
        float, typer.Option(help="Over which the response's errors go together; 0 for noise")
    ] = 0.0,
    relative: Annotated[bool, typer.Option("--relative", help="Do without radiances")] = False,
    no_darks: Annotated[bool, typer.Option("--no-darks", help="Do without capped darks")] = False,
    ignore_monitor: Annotated[
        bool,
        typer.Option("--ignore-monitor", help="Do not correct the light by what the monitor read"),
    ] = False,
    model: Annotated[
        Path | None,
        path_option(
            metavar="MODEL.toml",
            help="Take out what this model of the camera has beside the plain response, such as"
            " lag: of the calibration, and of all lines that the set corrects",
        ),
    ] = None,
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
        Path | None, path_option(metavar="FILE.html", help="Figures to judge it by")
    ] = None,
    store: Annotated[
        bool, typer.Option("--store", help="Add set and recording to the store; the set as a draft")
    ] = False,
    json: Json = None,
) -> None:
    """Determine DN0, VE and QE of every column, with their uncertainty (AgCam)."""
    check_together(
        radiances,
        lamp_spectra,
        spectral_response,
        relative=relative,
        only_spectra=(certificate_std, response_correlation_nm or None),
    )
    with answering(json) as answer:
        from calib.forward.model import Model  # noqa: PLC0415
        from calib.radiometric.calibrate import calibrate as determine  # noqa: PLC0415
        from calib.recording.open import open_recording  # noqa: PLC0415
        from calib.recording.tone import Tone  # noqa: PLC0415
        from service.cli.about import about  # noqa: PLC0415
        from service.cli.radiance_arguments import level_radiances  # noqa: PLC0415
        from service.cli.set_output import check_report, save_set  # noqa: PLC0415

        if store:
            _check_store()
        check_report(report)
        known_model = None if model is None else Model.named(str(model))
        opened = open_recording(recording)
        known_tone = Tone(*tone) if tone else None
        known = level_radiances(
            opened.header,
            table=radiances,
            lamp_spectra=lamp_spectra,
            spectral_response=spectral_response,
            certificate_std=certificate_std,
            correlation_nm=response_correlation_nm,
        )
        with about(recording), progress("Calibrating") as tell:
            calibration = determine(
                opened,
                radiances=known.by_level,
                radiance_unit=known.unit,
                source=known.source,
                origin=known.origin,
                tone=known_tone,
                order=order,
                relative=relative,
                darks_required=not no_darks,
                monitor="ignore" if ignore_monitor else "use",
                model=known_model,
                progress=share_of(tell, "statistics of every column"),
            )
        with _report(report, opened, calibration, known_tone):
            save_set(calibration.coefficients, out)
        told: dict[str, Any] = {
            **calibration.answer(),
            "path": str(out),
            "report": None if report is None else str(report),
        }
        if store:
            _keep(opened, calibration)
        answer.give(told, lambda console: show_calibration(console, told))


@contextmanager
def _report(
    path: Path | None, recording: "Recording", calibration: "Calibration", tone: "Tone | None"
) -> Iterator[None]:
    """Write the report, and take it away again where the set cannot be written: both or none."""
    if path is None:
        yield
        return
    from service.cli.reporting import write_calibration_report  # noqa: PLC0415

    write_calibration_report(path, recording, calibration, tone)
    try:
        yield
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def _check_store() -> None:
    """Say before the long work, and not after it, that the store takes nothing."""
    from service.cli.opened_store import opened_store  # noqa: PLC0415

    with opened_store() as store:
        store.check_writable()


def _keep(recording: "Recording", calibration: "Calibration") -> None:
    """Make the recording known to the store, and the set that comes from it a draft."""
    from service.cli.known_recording import make_known  # noqa: PLC0415
    from service.cli.opened_store import opened_store, who  # noqa: PLC0415
    from service.store.actor import Actor  # noqa: PLC0415

    digest = calibration.coefficients.provenance.recording_digest
    with opened_store() as store:
        make_known(store, recording, by=who(), digest=digest)
        store.sets.add(calibration.coefficients, by=Actor(who()))


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
            f" axis at column {with_std(told['axis_column_exact'], told['axis_column_std'])},"
            f" {number(told['edge_fall_percent'])} % fall at the edge",
            "responsivity": f"{with_std(at_axis['value'], at_axis['std'])} {at_axis['unit']}",
            "scatter along the line": f"{number(told['cov_before_percent'])} % before,"
            f" {number(told['cov_after_percent'])} % after",
            "reduced χ²": number(told["reduced_chi_squared"]),
            **({"taken out": ", ".join(told["departures"])} if told["departures"] else {}),
        },
    )
    for warning in told["warnings"]:
        console.print(f"! {warning}", markup=False)
