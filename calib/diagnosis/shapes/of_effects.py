"""The shapes in which an effect is looked for: its strength, and a grid of all else it has.

The grid follows from the parameters' units and bounds and from the recording's own scales: how long
it lasted, how bright it got, how many columns it has. No effect is known by its name here.
"""

from collections.abc import Sequence
from math import inf, isfinite

from calib.diagnosis.shapes.grids import Scales, grid, star
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.simulation.with_values import with_values
from calib.forward.departure import Departure
from calib.forward.effects.catalogue import CATALOGUE
from calib.forward.parameter import Parameter, parameters_of
from calib.forward.remembering import Remembering
from calib.recording.header import CameraHeader


def departures() -> tuple[type[Departure], ...]:
    """Return all of the catalogue that can be looked for."""
    return tuple(kind for kind in CATALOGUE if issubclass(kind, Departure))


def shapes_of(kind: type[Departure], scales: Scales) -> tuple[Shape, ...]:
    """Return the shapes of an effect, the plainest first."""
    told = parameters_of(kind)
    default = _fitted_to_camera(kind, scales)
    if default is None:
        return ()
    strengths = [n for n, p in told.items() if _is_strength(getattr(default, n), p)]
    grids = {
        name: grid(name, getattr(default, name), parameter, scales, issubclass(kind, Remembering))
        for name, parameter in told.items()
        if name not in strengths
    }
    shapes = []
    off_default = {n: g for n, g in grids.items() if g != (getattr(default, n),)}
    for template in star(default, off_default):
        shapes += _with_strength(template, strengths, told, scales.camera)
    return tuple(shapes)


def _is_strength(value: object, parameter: Parameter) -> bool:
    if isinstance(parameter.neutral, float) and isfinite(parameter.neutral):
        return isinstance(value, float)
    return parameter.neutral == () and isinstance(value, tuple)


def _fitted_to_camera(kind: type[Departure], scales: Scales) -> Departure | None:
    """Return the effect with its defaults, told what the camera is; None where it has none such."""
    camera = scales.camera
    names = set(parameters_of(kind))
    values: dict[str, object] = {}
    if "tap_layout" in names:
        values["tap_layout"] = camera.tap_layout if camera.taps > 1 else "single"
        if camera.taps < 2 and "tap" in kind.depends_on:
            return None
    for name in ("readout", "bit_depth"):
        if name in names:
            values[name] = getattr(camera, name)
    effect = with_values(kind(), values)
    for name, parameter in parameters_of(kind).items():
        if parameter.neutral == () and isinstance(getattr(effect, name), tuple) and camera.taps > 1:
            effect = with_values(effect, {name: (0.01,) * camera.taps})
    try:
        effect.check_camera(camera)
    except Exception:
        return None
    return effect


def one_or_against_others(unit: Sequence[float]) -> list[tuple[float, ...]]:
    """Return patterns in which one of several has its value alone, or as much as all others lose.

    >>> one_or_against_others((2.0, 2.0))
    [(2.0, 0.0), (0.0, 2.0), (1.0, -1.0)]
    """
    n = len(unit)
    alone = [tuple(u if k == j else 0.0 for k, u in enumerate(unit)) for j in range(n)]
    # Of two, either against the other is the same but for its sign.
    against = [tuple(u - sum(one) / n for u in one) for one in alone[: 1 if n == 2 else n]]
    return alone + against


def _with_strength(
    template: Departure,
    strengths: Sequence[str],
    told: dict[str, Parameter],
    camera: CameraHeader,
) -> list[Shape]:
    """Return one shape for each strength alone, and of one for all where they go together."""
    tuples = [n for n in strengths if isinstance(getattr(template, n), tuple)]
    if tuples:
        name = tuples[0]
        patterns = one_or_against_others(getattr(template, name))
        return [Shape(template, ((name, each, 0.0),), told[name].low < 0) for each in patterns]
    if not strengths or any(p.neutral == inf for p in told.values()):
        return [Shape(template, (), two_sided=False)]
    neutral = {n: float(told[n].neutral) for n in strengths}  # type: ignore[arg-type]
    size = {n: getattr(template, n) - neutral[n] for n in strengths}
    if len(strengths) > 1 and all(told[n].low < 0 for n in strengths):
        unit = max(abs(s) for s in size.values()) or 1.0
        rest = with_values(template, neutral)
        return [Shape(rest, ((n, unit, neutral[n]),), two_sided=True) for n in strengths]
    if len({told[n].unit for n in strengths}) > 1:
        # What differs in kind is no common strength: the first scales, a fit moves the others.
        strengths = strengths[:1]
    together = tuple((n, size[n], neutral[n]) for n in strengths if size[n] != 0)
    shapes = [Shape(template, together, all(told[n].low < neutral[n] for n in strengths))]
    if len(strengths) > 1:
        alone = tuple((n, max(size.values()), neutral[n]) for n in strengths)
        frame = camera.rows is not None and len(together) < len(strengths)
        shapes += _alone(with_values(template, neutral), alone, all_of_them=frame)
    return shapes


def _alone(
    rest: Departure, varied: tuple[tuple[str, float, float], ...], *, all_of_them: bool
) -> list[Shape]:
    """Return one shape for each of several strengths, and maybe of all, as strong as each other."""
    shapes = [Shape(rest, (one,), two_sided=False) for one in varied]
    # What a line does not have, a frame may have as strongly as all else.
    return [*shapes, Shape(rest, varied, two_sided=False)] if all_of_them else shapes
