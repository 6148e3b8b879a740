"""`darkflat investigate`: sweep, diagnose, run the deciding sweep, diagnose both together."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.errors import DarkflatError, InputError
from service.cli.answering import Json, answering
from service.cli.paths import path_option
from service.cli.progress import progress
from service.cli.shared_options import BenchFile

if TYPE_CHECKING:
    from service.investigation.investigate import Investigation
    from service.plan.model import Plan


def investigate(
    *,
    bench: BenchFile = None,
    plan: Annotated[
        Path | None,
        path_option(metavar="FIRST.toml", help="The first sweep; a simulated bench needs none"),
    ] = None,
    budget_s: Annotated[
        float | None,
        typer.Option("--budget-s", min=0.0, help="No later sweep ends after so many seconds"),
    ] = None,
    out: Annotated[Path, path_option(help="The folder for recordings and plans")] = Path(
        "investigation"
    ),
    json: Json = None,
) -> None:
    """Sweep and diagnose until what a camera does beyond the plain model has one name."""
    with answering(json) as answer:
        _refuse_full(out)
        done = _investigate(bench, plan, out, float("inf") if budget_s is None else budget_s)
        answer.give(done.answer(), lambda console: _show(console, done))


def _refuse_full(out: Path) -> None:
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        msg = f"{out} is there already and not empty: name another folder by --out"
        raise InputError(msg, code="output-exists")


def _investigate(
    bench_file: Path | None, plan_file: Path | None, out: Path, budget_s: float
) -> "Investigation":
    from calib.recording.durable import disk_errors  # noqa: PLC0415
    from service.bench import open_bench  # noqa: PLC0415
    from service.cli.asking import ask_for_cap  # noqa: PLC0415
    from service.cli.consoles import notes  # noqa: PLC0415
    from service.cli.simulated_bench import chosen_bench  # noqa: PLC0415
    from service.investigation.first_plan import first_plan  # noqa: PLC0415
    from service.investigation.investigate import investigate as investigated  # noqa: PLC0415
    from service.investigation.limits import bench_time  # noqa: PLC0415
    from service.plan.model import Plan  # noqa: PLC0415

    named = None if plan_file is None else Plan.load(plan_file)
    chosen = chosen_bench(bench_file)
    if chosen.remark:
        notes().print(chosen.remark, markup=False, style="dim")
    with (
        open_bench(chosen.settings, ask=ask_for_cap()) as bench,
        progress("Investigation") as report,
    ):
        first = first_plan(bench) if named is None else named
        with disk_errors(out):
            out.mkdir(parents=True, exist_ok=True)

        def take(plan: "Plan", recording: Path) -> None:
            _sweep(bench, plan, recording, report)

        return investigated(
            take, bench_time(bench, first), first, out, budget_s=budget_s, tell=report
        )


def _sweep(bench: Any, plan: "Plan", recording: Path, report: Any) -> None:
    from service.cli.stopping import polled, stop_wanted  # noqa: PLC0415
    from service.cli.sweep_progress import sweep_progress  # noqa: PLC0415
    from service.sequencer.run import run_plan  # noqa: PLC0415

    with polled():
        result = run_plan(
            bench, plan, recording, cancelled=stop_wanted, on_progress=sweep_progress(report)
        )
    if result.state != "succeeded":
        raise DarkflatError(
            f"stopped after {result.blocks_done} of {result.blocks_total} blocks of {recording},"
            " lamps off; what was recorded is there",
            code="cancelled",
        )


def _show(console: Any, done: "Investigation") -> None:
    from service.cli.commands.diagnose import show_diagnosis  # noqa: PLC0415

    for number, each in enumerate(done.rounds, start=1):
        names = [" or ".join(c.effect for c in f.candidates) for f in each.diagnosis.findings]
        told = "; ".join(names) or "nothing beyond the plain model"
        console.print(f"sweep {number}, {each.plan.name}: {told}", markup=False)
        following = each.diagnosis.next_measurement
        if following is not None and following.expected_sigma is not None:
            sigma = f"{following.expected_sigma:.1f} sigma expected"
            console.print(f"  next: {following.why} ({sigma})", markup=False)
    console.print(f"Outcome: {done.outcome}")
    show_diagnosis(console, done.examined.diagnosis.answer())
