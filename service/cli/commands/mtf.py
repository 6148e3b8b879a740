"""`darkflat mtf`: a scan of a self-imaging grating becomes the pixel's transfer function."""

import os
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option

if TYPE_CHECKING:
    from rich.console import Console


class MtfMethod(StrEnum):
    """How the transfer function is estimated."""

    REGULARISED = "regularised"
    FILTER = "filter"


def mtf(
    folder: Annotated[Path, path_argument(help="mtf.toml and frames/")],
    *,
    out: Annotated[Path, path_option(metavar="TF.h5", help="The transfer function to write")],
    method: Annotated[
        MtfMethod, typer.Option(help="Least squares on a compact PSF, or the 2018 paper's filter")
    ] = MtfMethod.REGULARISED,
    support: Annotated[
        int, typer.Option(min=3, max=5, help="Pixels beyond which crosstalk is taken as 0: 3 or 5")
    ] = 3,
    report: Annotated[
        Path | None, path_option(metavar="FILE.html", help="Figures to judge it by")
    ] = None,
    coefficient_set: Annotated[
        Path | None,
        path_option("--set", metavar="SET.h5", help="A coefficient set that shall carry it"),
    ] = None,
    set_out: Annotated[
        Path | None, path_option(metavar="NEW.h5", help="That set with it, under a new id")
    ] = None,
    json: Json = None,
) -> None:
    """Determine the pixel's transfer function and PSF, with their uncertainty."""
    if support not in {3, 5}:
        msg = "--support is 3 or 5"
        raise typer.BadParameter(msg)
    if (coefficient_set is None) != (set_out is None):
        msg = "--set and --set-out go together"
        raise typer.BadParameter(msg)
    # Thousands of small products: BLAS threads wait for each other longer than they work (36 s of
    # processor time against 6 s on a busy machine). Read when NumPy is first imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with answering(json) as answer:
        from calib.mtf.reading import read_toml  # noqa: PLC0415
        from calib.recording.durable import refuse_existing  # noqa: PLC0415
        from service.cli.mtf_work import of_edge, of_grating  # noqa: PLC0415
        from service.cli.set_output import check_distinct, check_report  # noqa: PLC0415

        check_distinct(out, set_out, report)
        refuse_existing(out)
        check_report(report)
        read = read_toml(folder)
        if read.edge is not None:
            told = of_edge(folder, read, out, report=report, coefficient_set=coefficient_set)
        else:
            told = of_grating(
                folder, read, out, method=method.value, support=support, report=report,
                coefficient_set=coefficient_set, set_out=set_out,
            )  # fmt: skip
        answer.give(told, lambda console: _show(console, told))


def _show(console: "Console", told: dict[str, Any]) -> None:
    from service.cli.tables import facts, number, with_std  # noqa: PLC0415

    def zero(axis: int) -> str:
        value, std = told["first_zero_per_mm"][axis], told["first_zero_std_per_mm"][axis]
        return "none" if value is None else f"{with_std(value, std)}/mm"

    nyquist = told["mtf_at_nyquist"]
    rows = {
        "transfer function": told["path"],
        "method": told["method"],
        "first zero along x": zero(0),
        "first zero along y": zero(1),
        "MTF at Nyquist, x": with_std(nyquist["x"], nyquist["std"]),
        "MTF at Nyquist, y": with_std(nyquist["y"], nyquist["std"]),
        "mean uncertainty": number(told["mean_transfer_std"], 2),
    }
    if told["grating_shift_um"] is not None:
        pairs = zip(told["grating_shift_um"], told["grating_shift_std_um"], strict=True)
        rows["pattern lies at"] = ", ".join(with_std(*pair) for pair in pairs) + " µm"
    facts(console, rows)
    for warning in told["warnings"]:
        console.print(f"! {warning}", markup=False)
