"""`darkflat diagnose`: what a recording shows beyond the plain model, or beyond a given one."""

from collections.abc import Callable
from functools import partial
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
        from calib.diagnosis.report.page import (  # noqa: PLC0415
            save_page,
            save_page_of_undiagnosed,
        )
        from calib.errors import NotDeterminedError  # noqa: PLC0415
        from calib.forward.model import Model  # noqa: PLC0415
        from calib.recording.durable import refuse_existing  # noqa: PLC0415
        from calib.recording.open import open_recording  # noqa: PLC0415
        from service.cli.about import about  # noqa: PLC0415
        from service.cli.set_output import check_report  # noqa: PLC0415

        if model_out is not None:
            refuse_existing(model_out)
        check_report(report)
        given = None if model is None else Model.named(model)
        opened = [open_recording(path) for path in recordings]
        title = f"Diagnosis of {' and '.join(path.name for path in recordings)}"
        with about(recordings[0]), progress("Diagnosing") as tell:
            try:
                diagnosis, examined, amended = _examined(opened, given, share_of(tell))
            except NotDeterminedError as error:
                if report is not None:
                    save_page_of_undiagnosed(error, report, title)
                raise
            if model_out is not None:
                amended().save(model_out)
            if report is not None:
                save_page(diagnosis, report, title, opened[0].header.camera, examined)
        told = diagnosis.answer()
        answer.give(told, lambda console: show_diagnosis(console, told))


def _examined(opened: list[Any], given: Any, tell: Callable[[float], None]) -> tuple[Any, Any, Any]:
    """Return the diagnosis, what it rests on, and what makes the amended model.

    Sums have a way of their own, and nothing of the second.
    """
    from calib.diagnosis import diagnose  # noqa: PLC0415
    from calib.diagnosis.answer import amended  # noqa: PLC0415
    from calib.diagnosis.deciding.decide import decided  # noqa: PLC0415
    from calib.diagnosis.recorded.joint import joint  # noqa: PLC0415
    from calib.diagnosis.sums import amended as amended_by_sums  # noqa: PLC0415
    from calib.diagnosis.sums.diagnose import diagnose_sums  # noqa: PLC0415

    if len(opened) == 1 and getattr(opened[0], "statistics", None):
        sums = diagnose_sums(opened[0])
        return sums.diagnosis, None, partial(amended_by_sums.amended_model, sums, given)
    whole = joint([each.header for each in opened])
    found = decided(diagnose.diagnose(opened, given, progress=tell), whole)
    source = whole.header.source
    model = partial(amended.amended_model, found.model, found.evidence, source, given)
    return found.diagnosis, found, model


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
