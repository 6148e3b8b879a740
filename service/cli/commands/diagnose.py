"""`darkflat diagnose`: what a recording shows beyond the plain model, or beyond a given one."""

from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of


def diagnose(
    recordings: Annotated[
        list[Path],
        path_argument(metavar="REC...", help="An .h5 or a recording folder; several of one bench"),
    ],
    *,
    model: Annotated[
        str | None, typer.Option(metavar="MODEL.toml", help="What it should be; or a preset's name")
    ] = None,
    report: Annotated[Path | None, path_option(metavar="OUT.html", help="A page to read")] = None,
    model_out: Annotated[
        Path | None,
        path_option(metavar="AMENDED.toml", help="The model with what was found, for simulate"),
    ] = None,
    json: Json = None,
) -> None:
    """Say what recordings show that the plain model lacks: where, what, and how much."""
    with answering(json) as answer:
        from calib.forward.model import Model  # noqa: PLC0415
        from calib.recording.durable import refuse_existing  # noqa: PLC0415
        from calib.recording.open import open_recording  # noqa: PLC0415
        from service.cli.about import about  # noqa: PLC0415
        from service.cli.set_output import check_report  # noqa: PLC0415
        from service.evaluation.diagnosis import take_diagnosis  # noqa: PLC0415

        if model_out is not None:
            refuse_existing(model_out)
        check_report(report)
        given = None if model is None else Model.named(model)
        opened = [open_recording(path) for path in recordings]
        title = f"Diagnosis of {' and '.join(path.name for path in recordings)}"
        with about(recordings[0]), progress("Diagnosing") as tell:
            diagnosis = take_diagnosis(
                opened,
                given,
                title=title,
                report=report,
                model_out=model_out,
                progress=share_of(tell),
            )
        told = diagnosis.answer()
        answer.give(told, lambda console: show_diagnosis(console, told))


def show_diagnosis(console: Any, told: dict[str, Any]) -> None:
    """Print what a person asks first."""
    console.print(f"Verdict: {told['verdict']}")
    console.print(told["summary"])
    for finding in told["findings"]:
        others = [c["effect"] for c in finding["candidates"][1:]]
        beside = f" (or {', '.join(others)})" if others else ""
        console.print(f"{finding['effect']}{beside}: {finding['significance_sigma']:.1f} sigma")
        sentence = finding["sentence"] or finding["physics"]
        console.print(f"  {sentence} {finding['hid_as']['text']}".rstrip())
        console.print(f"  {finding['where']['text']}")
        for name, each in finding["parameters"].items():
            console.print(f"  {name} = {each['value']:.4g} +- {each['std']:.2g} {each['unit']}")
    if told["unexplained"] is not None:
        console.print(f"Unexplained: {told['unexplained']['where']['text']}")
    for off in told["model_parameters"]:
        console.print(
            f"{off['name']}: {off['model']:.6g} in the model, {off['fitted']:.6g} +- "
            f"{off['std']:.2g} {off['unit']} in the recording"
        )
    for remark in told["remarks"]:
        console.print(remark)
    following = told["next_measurement"]
    if following is not None and following["expected_sigma"] is not None:
        console.print(
            f"Next: it {following['why']}, by {following['expected_sigma']:.1f} sigma, in "
            f"{following['seconds']:.0f} s; --json has its plan",
            markup=False,
        )
