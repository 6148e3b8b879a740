"""Effects at zero strength, and so strong that a few lines show them."""

from typing import Any

from calib.forward.effect import Effect
from calib.forward.parameter import parameters_of

_STRONGER: dict[str, dict[str, Any]] = {
    "cosmic_rays": {"per_pixel_s": 2e3},
    "duplicated_lines": {"probability": 0.9},
    "gain_drift": {"time_constant_s": 1e-3},
    "hot_pixels": {"share": 0.05},
    "lamp_drift": {"time_constant_s": 1e-3},
    "offset_drift": {"amplitude_dn": 3.0, "time_constant_s": 1e-3},
    "saturation_knee": {"threshold_e": 8_000.0},
    "tap_gain_drift": {"time_constant_s": 1e-3},
}
"""Where an effect's defaults, which are those of a real recording, do not."""


def shown(kind: type[Effect]) -> Effect:
    """The effect, strong enough to show in a few lines of 40 us."""
    return kind(**_STRONGER.get(kind.name, {}))


def neutral(kind: type[Effect]) -> Effect | None:
    """The effect at zero strength, None where it has none."""
    values = {n: p.neutral for n, p in parameters_of(kind).items() if p.neutral is not None}
    return kind(**values) if values else None
