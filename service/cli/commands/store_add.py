"""`darkflat store add`: keep a coefficient set."""

from pathlib import Path
from typing import Annotated

from service.cli.answering import Json, answering
from service.cli.paths import path_argument
from service.cli.shared_options import By


def add(
    file: Annotated[Path, path_argument(metavar="SET.h5")],
    by: By = None,
    json: Json = None,
) -> None:
    """Keep a coefficient set as a draft."""
    with answering(json) as answer:
        from calib.radiometric.coefficients.coefficient_set import CoefficientSet  # noqa: PLC0415
        from service.cli.set_step import take_step  # noqa: PLC0415

        coefficients = CoefficientSet.load(file)
        take_step(answer, by, lambda sets, actor: sets.add(coefficients, by=actor))
