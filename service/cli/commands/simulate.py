"""`darkflat simulate`: the recording that a model would give."""

from pathlib import Path
from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of


def simulate(
    model: Annotated[str, typer.Argument(metavar="MODEL.toml", help="Or the name of a preset")],
    plan: Annotated[Path, path_argument(metavar="PLAN.toml")],
    out: Annotated[
        Path, path_option(help="The recording to write: .h5, or a folder where it has no ending")
    ],
    seed: Annotated[int | None, typer.Option(min=0, help="The same one, the same frames")] = None,
    json: Json = None,
) -> None:
    """Draw the recording that a model's camera would make of a plan."""
    with answering(json) as answer:
        from calib.forward.model import Model  # noqa: PLC0415
        from service.cli.about import about  # noqa: PLC0415
        from service.cli.recording_summary import show, summary  # noqa: PLC0415
        from service.cli.simulated_recording import simulate_recording  # noqa: PLC0415
        from service.plan.model import Plan  # noqa: PLC0415

        forward, planned = Model.named(model), Plan.load(plan)
        with about(plan), progress("Simulating") as report:
            recording = simulate_recording(
                forward,
                planned,
                out,
                seed=seed,
                scenes_folder=plan.parent / "scenes",
                progress=share_of(report),
            )
        told = {**summary(recording), "seed": seed}
        answer.give(told, show(told))
