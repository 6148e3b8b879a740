"""`darkflat apply`: raw DN into radiance, with its uncertainty and a flag per pixel."""

from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of


class Pane(StrEnum):
    """Those of `calib.radiometric.correction.transmittance`."""

    DESTINY_RED = "destiny-red"
    DESTINY_NIR = "destiny-nir"


def apply(
    coefficient_set: Annotated[
        str, typer.Argument(metavar="SET.h5", help="Or the id of a certified set in the store")
    ],
    frames: Annotated[
        Path, path_argument(help="A recording, or lines in .npy, .tif, .fits (with --exposure-us)")
    ],
    *,
    out: Annotated[Path, path_option(help="The HDF5 file to write")],
    exposure_us: Annotated[
        float | None, typer.Option(min=0, help="Of a bare file of lines, which does not say")
    ] = None,
    at: Annotated[
        datetime | None, typer.Option(help="When the lines were taken, UTC; else as they say")
    ] = None,
    block: Annotated[
        list[str] | None,
        typer.Option(help="Only this block; may be given repeatedly; else all but capped darks"),
    ] = None,
    transmittance: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="T STD", help="Of a window that was not there when calibrating"),
    ] = None,
    window: Annotated[
        Pane | None, typer.Option(help="A window whose transmittance is known, instead of T STD")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Although the set does not match; flags say so")
    ] = False,
    no_std: Annotated[bool, typer.Option("--no-std", help="Leave the uncertainty out")] = False,
    json: Json = None,
) -> None:
    """Correct lines: radiance, its standard uncertainty and a quality flag per pixel."""
    if window and transmittance:
        raise typer.BadParameter("give --window or --transmittance, not both")
    with answering(json) as answer:
        from calib.radiometric.correction.apply_options import ApplyOptions  # noqa: PLC0415
        from calib.radiometric.correction.apply_recording import correct_recording  # noqa: PLC0415
        from calib.radiometric.correction.transmittance import WINDOWS, Window  # noqa: PLC0415
        from service.cli.about import about  # noqa: PLC0415
        from service.cli.frames_argument import open_frames  # noqa: PLC0415
        from service.cli.set_output import load_set  # noqa: PLC0415
        from service.cli.stopping import stop_wanted  # noqa: PLC0415

        coefficients, validity = load_set(coefficient_set)
        recording = open_frames(frames, coefficients.camera, exposure_us)
        pane = WINDOWS[window.value] if window else None
        options = ApplyOptions(
            window=Window(*transmittance) if transmittance else pane,
            validity=validity,
            at=at.replace(tzinfo=UTC) if at and at.tzinfo is None else at,
            force=force,
            std=not no_std,
            blocks=block or None,
        )
        with about(frames), progress("Correcting") as report:
            done = correct_recording(
                recording,
                coefficients,
                out,
                options=options,
                progress=share_of(report),
                cancelled=stop_wanted,
            )
        told: dict[str, Any] = {
            "path": str(done.path),
            "coefficient_set": done.coefficient_set,
            "radiance_unit": done.radiance_unit,
            "blocks": list(done.blocks),
            "left_out": list(done.left_out),
            "lines": done.n_lines,
            "flags": done.flags,
            "notes": [*recording.warnings, *done.notes],
        }
        answer.give(told, lambda console: _show(console, told))


def _show(console: Any, told: dict[str, Any]) -> None:
    flags = ", ".join(f"{count} {name}" for name, count in told["flags"].items() if count)
    console.print(
        f"{told['path']}: {told['lines']} lines of {len(told['blocks'])} blocks in"
        f" {told['radiance_unit']}; pixels: {flags or 'none flagged'}",
        markup=False,
    )
    if told["left_out"]:
        console.print(
            f"{len(told['left_out'])} capped darks were left out; --block corrects one by name",
            markup=False,
        )
    for note in told["notes"]:
        console.print(f"! {note}", markup=False)
