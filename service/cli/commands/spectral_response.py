"""`darkflat spectral-response`: a monochromator scan becomes the camera's spectral response."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option

if TYPE_CHECKING:
    from rich.console import Console


def spectral_response(
    scan_folder: Annotated[
        Path, path_argument(help="scan.csv, reference.csv, photodiode.csv, and frames/ if any")
    ],
    *,
    out: Annotated[
        Path, path_option(metavar="RESPONSE.csv", help="The response to write, with its std")
    ],
    angle_deg: Annotated[float, typer.Option(help="Of incidence; one of the scan's")] = 0.0,
    figure: Annotated[
        Path | None, path_option(metavar="FILE", help="A drawing: .svg, .png or .pdf")
    ] = None,
    json: Json = None,
) -> None:
    """Reduce a monochromator scan: spectral response, bandwidth, drift, change with the angle."""
    with answering(json) as answer:
        from calib.radiometric.spectral.spectral_response_answer import response_answer  # noqa: PLC0415
        from calib.radiometric.spectral.spectral_response_scan import SpectralScan  # noqa: PLC0415
        from calib.recording.durable import refuse_existing  # noqa: PLC0415
        from service.cli.figure_file import check_figure, write_figure  # noqa: PLC0415

        refuse_existing(out)
        check_figure(figure)
        scan = SpectralScan.load(scan_folder)
        found = response_answer(scan, angle_deg)
        comment = f"relative response at {angle_deg:g} degrees; response_std has k = 1"
        scan.at_angle(angle_deg).save(out, comment=comment)
        if figure is not None:
            from calib.radiometric.report.spectral import spectral_response as draw  # noqa: PLC0415

            write_figure(figure, lambda: draw(scan, angle_deg))
        told = {"path": str(out), "figure": str(figure) if figure else None, **found}
        answer.give(told, lambda console: _show(console, told))


def _show(console: "Console", told: dict[str, Any]) -> None:
    from service.cli.tables import facts, number, table, with_std  # noqa: PLC0415

    def figure(name: str, unit: str, factor: float = 1.0) -> str:
        known = told[name]
        if known is None:
            return "not determined"
        return f"{with_std(factor * known['value'], factor * known['std'])} {unit}"

    facts(
        console,
        {
            "response": f"{told['path']}, at {told['angle_deg']:g}°,"
            f" {told['wavelengths']} wavelengths",
            "centre": figure("centre_wavelength_nm", "nm"),
            "FWHM": figure("fwhm_nm", "nm"),
            "centroid": figure("centroid_nm", "nm"),
            "out of band": figure("out_of_band_fraction", "%", 100),
            "drift": f"{number(100 * told['drift']['largest'], 2)} % at most",
        },
    )
    rows = [
        (
            f"{each['angle_deg']:g}",
            with_std(each["centroid_shift_nm"]["value"], each["centroid_shift_nm"]["std"]),
            f"{each['significance_sigma']:+.1f}",
        )
        for each in told["angles"]
    ]
    if rows:
        table(console, ("angle, °", "shift of the centroid, nm", "difference, sigma"), rows)
    for warning in told["warnings"]:
        console.print(f"! {warning}", markup=False)
