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
        from service.cli.opened_store import opened_store, who  # noqa: PLC0415
        from service.cli.set_record import show_record, told  # noqa: PLC0415
        from service.store.actor import Actor  # noqa: PLC0415

        coefficients = CoefficientSet.load(file)
        with opened_store() as store:
            record = store.sets.add(coefficients, by=Actor(by or who()))
        answer.give(told(record), show_record(record))
