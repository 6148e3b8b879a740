"""A shape of an effect: the direction in which it is looked for, but for how strong it is."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

from calib.diagnosis.simulation.with_values import with_values
from calib.forward.departure import Departure
from calib.forward.parameter import parameters_of


@dataclass(frozen=True)
class Shape:
    """An effect but for its strength.

    Attributes:
        template: The effect at strength 1, and what its other parameters are.
        varied: The parameters that the strength scales, with their values at strength 1.
        two_sided: Whether the strength may be negative.
        freedom: How many numbers were fitted to the recording to arrive at this shape.
        credit: Deviance that single samples give it beyond what sums of counts do.
        of_codes: Likewise of counts of single codes; less than 0 where these contradict it.
        shared: Of the credit, what other names beside it are credited with, too, by name.
    """

    template: Departure
    varied: tuple[tuple[str, float | tuple[float, ...], float], ...]
    two_sided: bool
    freedom: float = 0.0
    credit: float = 0.0
    of_codes: float = 0.0
    shared: tuple[tuple[str, float], ...] = ()

    @property
    def cost(self) -> float:
        """Deviance that it explains by chance: what it was fitted to is what it is tried on."""
        return 2.0 * self.freedom - self.credit - self.of_codes

    @property
    def name(self) -> str:
        """The effect's name."""
        return self.template.name

    def at(self, strength: float, inner: Mapping[str, float] | None = None) -> Departure:
        """Return the effect at a strength, held within the bounds of its parameters.

        Args:
            strength: Times the varied parameters' distance from where they change nothing.
            inner: Values of other parameters, in place of the shape's own: of varied ones, too,
                which the strength does not scale then.
        """
        told = parameters_of(type(self.template))
        values: dict[str, object] = {
            name: _held(value, told[name].low, told[name].high)
            for name, value in (inner or {}).items()
        }
        for name, unit, neutral in self.varied:
            if inner and name in inner:
                continue
            low, high = told[name].low, told[name].high
            if isinstance(unit, tuple):
                values[name] = tuple(_held(neutral + strength * u, low, high) for u in unit)
            else:
                values[name] = _held(neutral + strength * unit, low, high)
        return with_values(self.template, values)

    @property
    def most(self) -> float:
        """The largest strength at which none of what it scales is at a bound; of two signs, any."""
        if self.two_sided:
            return inf
        told, ends = parameters_of(type(self.template)), [inf]
        for name, unit, neutral in self.varied:
            parameter = told[name]
            for each in unit if isinstance(unit, tuple) else (unit,):
                end = parameter.high if each > 0.0 else parameter.low
                ends += [(end - neutral) / each] if each else []
        return min(ends)

    @property
    def inner(self) -> tuple[str, ...]:
        """The positive numbers besides the strength that a fit may move, those at a bound not.

        Where several go together, the first is the strength, and how the others are to it is one
        of a kind of sensor. How widely pixels scatter that a seed draws is left as it is: the
        recording's pixels are others.
        """
        if self.freedom:
            return ()
        told, varied = parameters_of(type(self.template)), {name for name, _, _ in self.varied[:1]}
        drawn = any(name.endswith("seed") for name in told)
        return tuple(
            name
            for name, parameter in told.items()
            if name not in varied
            and isinstance(value := getattr(self.template, name), float)
            and 0.0 < value < parameter.high
            and parameter.low < value
            and not name.startswith("reference")
            and not (drawn and parameter.neutral == 0.0)
            and parameter.unit not in {"rad", "Hz", "degree Celsius"}
        )

    @property
    def fixed(self) -> bool:
        """Whether it has no strength: a grid of its own stands for it."""
        return not self.varied


def _held(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
