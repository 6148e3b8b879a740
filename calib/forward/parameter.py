"""What a parameter of an effect says about itself, and how it is held to it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from math import inf
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from calib.errors import InputError

T = TypeVar("T")


@dataclass(frozen=True)
class Parameter:
    """Unit and bounds of one field.

    Attributes:
        unit: "1" where it has none, "" for a name.
        low, high: Bounds, both allowed values; they hold for each element of a tuple.
        neutral: The value at which the parameter changes nothing; None where there is none.
        choices: The allowed words, for names.
    """

    unit: str
    low: float = -inf
    high: float = inf
    neutral: object = None
    choices: tuple[str, ...] = ()


def parameter(
    default: object,
    *,
    unit: str,
    low: float = -inf,
    high: float = inf,
    neutral: object = None,
    choices: tuple[str, ...] = (),
) -> Any:
    """Declare a field of an effect with its unit, bounds and default."""
    return field(
        default=default,
        metadata={"parameter": Parameter(unit, low, high, neutral, choices)},
    )


def parameters_of(kind: type) -> dict[str, Parameter]:
    """Return what the fields of `kind`, a dataclass, say about themselves."""
    return {f.name: f.metadata["parameter"] for f in fields(kind)}


def check_parameters(effect: object, where: str) -> None:
    """Raise InputError naming the first parameter of `effect` outside its bounds."""
    for name, told in parameters_of(type(effect)).items():
        value = getattr(effect, name)
        if told.choices and value not in told.choices:
            raise InputError(
                f"{where}: {name} is {value!r}; give one of {', '.join(told.choices)}.",
                code="parameter-out-of-bounds",
            )
        numbers = value if isinstance(value, tuple) else (value,)
        for number in numbers:
            if isinstance(number, float | int) and not told.low <= number <= told.high:
                raise InputError(
                    f"{where}: {name} is {number}; give {told.low} to {told.high} "
                    f"(unit: {told.unit}).",
                    code="parameter-out-of-bounds",
                )


def from_table(kind: type[T], table: Mapping[str, object], where: str) -> T:
    """Build a `kind` from a TOML table; unknown keys and wrong types are InputErrors."""
    told = parameters_of(kind)
    for key in table:
        if key not in told:
            allowed = ", ".join(told) or "no keys"
            raise InputError(
                f"{where}: unknown key {key!r}; allowed: {allowed}.", code="unknown-key"
            )
    hints = get_type_hints(kind)
    values = {key: _typed(value, hints[key], f"{where}: {key}") for key, value in table.items()}
    try:
        return kind(**values)
    except InputError as error:
        raise InputError(f"{where}: {error}", code=error.code) from error


def to_table(effect: object) -> dict[str, object]:
    """Return the parameters of `effect` as TOML knows them; None is left out."""
    values = {name: getattr(effect, name) for name in parameters_of(type(effect))}
    return {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in values.items()
        if value is not None
    }


def _typed(value: object, hint: Any, where: str) -> object:
    """Return `value` as the annotation `hint` wants it."""
    if get_origin(hint) is tuple:
        if isinstance(value, list):
            return tuple(_typed(element, get_args(hint)[0], where) for element in value)
    else:
        wanted = get_args(hint) or (hint,)
        number = isinstance(value, float | int) and not isinstance(value, bool)
        if float in wanted and number:
            return float(value)  # type: ignore[arg-type]  # `number` says what it is
        if type(value) in wanted:
            return value
    described = getattr(hint, "__name__", str(hint))
    raise InputError(f"{where} is {value!r}; give a value of type {described}.", code="wrong-type")
