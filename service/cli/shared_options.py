"""Options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

from service.cli.paths import path_option

By = Annotated[str | None, typer.Option(help="Who; the user's name where not given")]
Limit = Annotated[int, typer.Option(min=1, max=500)]
Before = Annotated[
    int | None, typer.Option(help="Go on behind this `next_before` of an earlier answer")
]
BenchFile = Annotated[
    Path | None, path_option(metavar="bench.toml", help="Else ./bench.toml, else simulated")
]
