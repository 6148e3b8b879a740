"""What every part of a plan is: frozen, and strict about its keys."""

from collections.abc import Iterator, Mapping
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, model_validator

LARGEST = 1e18
"""Beyond any number that a bench knows; sums and products of such stay finite."""


class PlanPart(BaseModel):
    """An unknown key is an error, so that a typo in a plan cannot change what is measured."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="after")
    def _numbers_of_this_world(self) -> Self:
        for name in type(self).model_fields:
            for number in _numbers(getattr(self, name)):
                if abs(number) > LARGEST:
                    msg = f"{name} is beyond {LARGEST:g}; give the number in its unit"
                    raise ValueError(msg)
        return self


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, int | float):
        yield value
    elif isinstance(value, tuple):
        for each in value:
            yield from _numbers(each)
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield from _numbers(key)
            yield from _numbers(each)
