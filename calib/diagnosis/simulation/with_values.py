"""An effect with some of its parameters changed."""

from collections.abc import Mapping
from typing import Any, TypeVar

from calib.forward.effect import Effect
from calib.forward.parameter import parameters_of

E = TypeVar("E", bound=Effect)


def with_values(effect: E, values: Mapping[str, object]) -> E:
    """Return `effect` with the parameters of those names set; the others stay."""
    own: dict[str, Any] = {name: getattr(effect, name) for name in parameters_of(type(effect))}
    return type(effect)(**{**own, **values})
