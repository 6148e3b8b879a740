"""`darkflat sweep`: run a plan on a bench."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.errors import DarkflatError
from service.cli.answering import Answer, Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress
from service.cli.shared_options import BenchFile

if TYPE_CHECKING:
    from service.plan.model import Plan
    from service.sequencer.events import RunResult


def sweep(
    plan: Annotated[Path, path_argument(metavar="PLAN.toml")],
    *,
    out: Annotated[
        Path | None, path_option(metavar="REC.h5", help="The recording to write")
    ] = None,
    bench: BenchFile = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on at the first block that is not whole")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print every step and the time; nothing moves")
    ] = False,
    json: Json = None,
) -> None:
    """Run a plan on a bench; at every end the lamps are off and read back."""
    if out is None and not dry_run:
        raise typer.BadParameter("name the recording to write", param_hint="--out")
    with answering(json) as answer:
        from service.plan.model import Plan  # noqa: PLC0415

        loaded = Plan.load(plan)
        if dry_run or out is None:
            _check_level(loaded, bench)
            _tell_steps(loaded, answer)
            return
        result = _run(loaded, bench, out, resume=resume)
        if result.state != "succeeded":
            raise _stopped(result)
        told = {
            "state": result.state,
            "recording": str(result.path),
            "blocks_done": result.blocks_done,
            "blocks_total": result.blocks_total,
            "skipped": list(result.skipped),
            "frames": result.frames,
            "lost_frames": result.lost_frames,
            "notes": list(result.notes),
            "seconds": result.seconds,
        }
        answer.give(told, lambda console: _show(console, told))


def _stopped(result: "RunResult") -> DarkflatError:
    return DarkflatError(
        f"stopped after {result.blocks_done} of {result.blocks_total} blocks, lamps off; go on"
        f" with --resume --out {result.path}",
        code="cancelled",
    )


def _check_level(plan: "Plan", bench_file: Path | None) -> None:
    """Refuse levels that the bench's file has no lamps for; nothing is opened for that."""
    from service.bench.level_range import check_levels  # noqa: PLC0415
    from service.cli.simulated_bench import chosen_bench  # noqa: PLC0415

    settings = chosen_bench(bench_file).settings
    if settings.max_level is not None:
        check_levels(plan.levels(), settings.max_level, settings.id)


def _tell_steps(plan: "Plan", answer: Answer) -> None:
    from service.plan.describe import describe  # noqa: PLC0415
    from service.plan.estimate import estimate  # noqa: PLC0415
    from service.plan.expand import expand  # noqa: PLC0415

    steps = expand(plan)
    ahead = estimate(plan, steps, columns=plan.camera.columns or 1, rows=plan.camera.rows)
    content = {
        "steps": [
            {**step.block.model_dump(exclude_none=True), "burning": step.burning} for step in steps
        ],
        "exposing_s": ahead.exposing_s,
        "waiting_s": ahead.waiting_s,
        "reading_s": ahead.reading_s,
        "total_s": ahead.total_s,
        "bytes": ahead.n_bytes if plan.camera.columns else None,
    }
    answer.give(content, lambda console: console.print(describe(plan), markup=False))


def _run(plan: "Plan", bench_file: Path | None, out: Path, *, resume: bool) -> "RunResult":
    from service.bench import open_bench  # noqa: PLC0415
    from service.cli.asking import ask_for_cap  # noqa: PLC0415
    from service.cli.consoles import notes  # noqa: PLC0415
    from service.cli.simulated_bench import chosen_bench  # noqa: PLC0415
    from service.cli.stopping import polled, stop_wanted  # noqa: PLC0415
    from service.cli.sweep_progress import sweep_progress  # noqa: PLC0415
    from service.sequencer.begin import check_output  # noqa: PLC0415
    from service.sequencer.run import run_plan  # noqa: PLC0415

    check_output(out, resume=resume)
    chosen = chosen_bench(bench_file)
    if chosen.remark:
        notes().print(chosen.remark, markup=False, style="dim")
    with (
        open_bench(chosen.settings, ask=ask_for_cap()) as bench,
        progress("Sweep") as report,
        polled(),
    ):
        return run_plan(
            bench,
            plan,
            out,
            resume=resume,
            cancelled=stop_wanted,
            on_progress=sweep_progress(report),
        )


def _show(console: Any, told: dict[str, Any]) -> None:
    console.print(
        f"{told['recording']}: {told['blocks_done']} of {told['blocks_total']} blocks,"
        f" {told['frames']} frames, {told['lost_frames']} lost and taken again;"
        f" {told['state']} after {told['seconds']:.1f} s, lamps off",
        markup=False,
    )
    for note in told["notes"]:
        console.print(f"! {note}", markup=False)
