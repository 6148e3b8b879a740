"""What a coefficient set says of departures: what was taken out of it is taken out of lines."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.empirical import Empirical
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.parameter import from_table, to_table

_INFINITY = "inf"


@dataclass(frozen=True)
class Departures:
    """Names and parameters, as in a model file, and the conditions that stand for unknown ones.

    Attributes:
        effects: Parameters by name of the departure; `vignette`'s and `system_gain`'s among them.
        line_period_us: From line to line.
        time_s: The flats' mean wall time since the recording's start.
        temperature_c: Their mean sensor temperature; None where none was recorded.
        cannot_be_undone: Departures of the model that no correction deals with.
    """

    effects: Mapping[str, Mapping[str, Any]]
    line_period_us: float
    time_s: float
    temperature_c: float | None = None
    cannot_be_undone: tuple[str, ...] = ()

    @classmethod
    def tables(cls, effects: Iterable[Effect]) -> dict[str, dict[str, Any]]:
        """Return the parameters of effects by name."""
        return {
            effect.name: {k: _for_json(v) for k, v in to_table(effect).items()}
            for effect in effects
        }

    @property
    def departures(self) -> tuple[Departure | Empirical, ...]:
        """The departures themselves, an empirical term among them."""
        return tuple(e for e in self._built() if isinstance(e, Departure | Empirical))

    @property
    def taken_out(self) -> dict[str, dict[str, Any]]:
        """Their parameters by name, without those of the lens and the system gain."""
        return self.tables(self.departures)

    @property
    def gain(self) -> SystemGain:
        """How electrons become DN."""
        return next(e for e in self._built() if isinstance(e, SystemGain))

    @property
    def vignette(self) -> Vignette:
        """The lens, behind which some departures act."""
        return next((e for e in self._built() if isinstance(e, Vignette)), Vignette())

    def _built(self) -> list[Effect]:
        where = "coefficient set"
        tables = {n: {k: _from_json(v) for k, v in t.items()} for n, t in self.effects.items()}
        return [from_table(effect_named(n), t, f"{where}: {n}") for n, t in tables.items()]


def _for_json(value: Any) -> Any:
    """Return a word for infinity, which JSON does not know."""
    return _INFINITY if value == inf else value


def _from_json(value: Any) -> Any:
    return inf if value == _INFINITY else value
