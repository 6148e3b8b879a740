"""How sure the parameters of a model are, where a fit or a certificate says so.

Standard uncertainties (JCGM 100:2008, k = 1) by effect and parameter, each in its parameter's unit.
Parameters are taken to err independently of each other.
"""

from collections.abc import Mapping, Sequence
from math import inf

from calib.errors import InputError
from calib.forward.effect import Effect

Uncertainty = Mapping[str, Mapping[str, float]]


def read_uncertainty(document: Mapping[str, object], where: str) -> Uncertainty:
    """Return the table `uncertainty` of a model file, {} where it has none."""
    table = document.get("uncertainty", {})
    if not isinstance(table, dict) or not all(isinstance(t, dict) for t in table.values()):
        raise InputError(
            f"{where}: [uncertainty] is not a table of tables; write [uncertainty.EFFECT].",
            code="wrong-type",
        )
    return table


def check_uncertainty(uncertainty: Uncertainty, effects: Sequence[Effect]) -> None:
    """Raise InputError unless each is a number from 0 on, of a parameter that is a number."""
    known = {effect.name: effect for effect in effects}
    for name, stds in uncertainty.items():
        if name not in known:
            raise InputError(
                f"[uncertainty.{name}]: the model has no effect {name!r}; give those of "
                f"{', '.join(known)}.",
                code="effect-missing",
            )
        for parameter, std in stds.items():
            value = getattr(known[name], parameter, None)
            if not isinstance(value, float):
                raise InputError(
                    f"[uncertainty.{name}]: {parameter!r} is no number of effect {name}; name one.",
                    code="unknown-key",
                )
            _check_std(std, f"[uncertainty.{name}]: {parameter}")


def _check_std(std: object, where: str) -> None:
    if isinstance(std, bool) or not (isinstance(std, float | int) and 0 <= std < inf):
        raise InputError(f"{where} = {std!r}; give a number from 0 on.", code="bad-uncertainty")
