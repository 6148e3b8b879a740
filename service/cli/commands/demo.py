"""`darkflat demo`: the whole way on a simulated bench, in under a minute."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_option
from service.cli.progress import progress

if TYPE_CHECKING:
    from rich.console import Console

    from service.cli.demonstration import Demonstration


def demo(
    *,
    out: Annotated[Path, path_option(help="The folder for what it makes")] = Path("demo"),
    seed: Annotated[int | None, typer.Option(min=0, help="Of the simulated noise")] = None,
    json: Json = None,
) -> None:
    """Simulated bench, sweep, calibration, correction, diagnosis, and reports to look at."""
    with answering(json) as answer:
        from service.cli.consoles import notes  # noqa: PLC0415
        from service.cli.demonstration import demonstrate  # noqa: PLC0415
        from service.cli.simulated_bench import simulated_bench  # noqa: PLC0415

        bench = simulated_bench(seed=seed)
        notes().print(bench.remark, markup=False, style="dim")
        with progress("Demo") as report:
            done = demonstrate(bench, out, report)
        answer.give(done.answer, lambda console: _show(console, done))


def _show(console: "Console", done: "Demonstration") -> None:
    from service.cli.commands.calibrate import show_calibration  # noqa: PLC0415
    from service.cli.sparkline import sparkline  # noqa: PLC0415

    told: dict[str, Any] = done.answer
    console.print(
        f"[bold]{told['frames']} frames[/] over {told['transport']}, {told['lost_frames']} lost;"
        f" lamps, monitor and shutter over {told['serial']}"
    )
    console.print()
    valid = done.calibration.coefficients.valid
    _profile(console, "raw, DN", sparkline(list(done.raw_dn)))
    _profile(console, "radiance", sparkline([float(x) for x in done.radiance[valid]]))
    console.print()
    show_calibration(console, done.calibration.answer())
    console.print()
    diagnosis = told["diagnosis"]
    console.print(f"[bold]diagnosis[/]  {diagnosis['summary']}")
    for each in diagnosis["findings"]:
        console.print(f"  {each['sentence']} {each['hid_as']['text']}")
    console.print()
    console.print(
        f"[bold]look at[/]  {told['report']}, {diagnosis['report']}   ({told['seconds']:.0f} s)"
    )


def _profile(console: "Console", name: str, line: str) -> None:
    console.print(f"[bold]{name:<9}[/] [cyan]{line}[/]")
