"""Arguments that are paths: a file that cannot be read is no wrong usage, the work says so."""

from typing import Any

import typer


def path_argument(**told: Any) -> Any:
    """Return a Typer argument whose rights the parser leaves alone."""
    return typer.Argument(readable=False, **told)


def path_option(*names: str, **told: Any) -> Any:
    """Return a Typer option whose rights the parser leaves alone."""
    return typer.Option(*names, readable=False, **told)
