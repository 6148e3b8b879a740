"""A step of a coefficient set's life, taken by a command."""

from collections.abc import Callable

from service.cli.answering import Answer
from service.cli.opened_store import opened_store, who
from service.cli.set_record import show_record, told
from service.store.actor import Actor
from service.store.coefficient_sets import CoefficientSets
from service.store.records import SetRecord


def take_step(
    answer: Answer, by: str | None, step: Callable[[CoefficientSets, Actor], SetRecord]
) -> None:
    """Take a step in somebody's name, the user's where None, and answer with the set."""
    with opened_store() as store:
        record = step(store.sets, Actor(by or who()))
    answer.give(told(record), show_record(record))
