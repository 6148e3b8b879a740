"""What the demonstration measures: an exposure sweep, a level sweep, and darks between them."""

from itertools import accumulate
from typing import Any

from calib.forward.effects.illumination import Illumination
from calib.forward.model import Model
from service.plan.model import Plan

_LINES = 1024
_FRAME_LINES = 128
_REFERENCE_LEVEL = 4
_LEVELS = (1, 2, 4)
_EXPOSURES_US = (10.0, 30.0, 60.0, 90.0)
_REFERENCE_US = 60.0

_STATED = {
    "identity": "simulated sphere",
    "standard": "none: the forward model",
    "certificate": "demo",
    "certificate_relative_std": 0.01,
    "level_relative_std": 0.002,
    "nonuniformity_relative": 0.01,
    "monitor_relative_std": 0.002,
}
"""The simulated sphere has none of these errors; a certificate of a real one states such figures,
and AgCam's source is Lambertian within 1 %."""


def demo_plan(model: Model, *, lamps: int) -> Plan:
    """Return the plan for `model`'s camera; the certificate's radiances are the model's own.

    `lamps` is how many the bench has, at least as many as the highest level.
    """
    camera = model.camera
    blocks: list[dict[str, Any]] = []
    for i, level in enumerate(_LEVELS):
        exposures_us = _EXPOSURES_US if level == _REFERENCE_LEVEL else (_REFERENCE_US,)
        # A dark before each level, of ever longer exposure: the lamps burn behind the cap.
        blocks.append({"kind": "dark", "exposure_us": _EXPOSURES_US[i + 1], "level": level})
        blocks += [{"exposure_us": exposure_us, "level": level} for exposure_us in exposures_us]
    return Plan.parse(
        {
            "name": "demo",
            "lines": _LINES,
            "frame_lines": _FRAME_LINES,
            "sweep": {"type": "listed", "blocks": blocks},
            "camera": {
                "line_period_us": camera.line_period_us,
                "pixel_format": f"Mono{camera.bit_depth}",
                "band": camera.band,
                "taps": camera.taps,
                "tap_layout": camera.tap_layout,
            },
            "source": {
                "kind": "sphere",
                "lamps": lamps,
                "radiance_unit": model.source.radiance_unit,
                "radiance": _certificate(model),
                **_STATED,
            },
            "settle": {
                "tolerance_percent": 0.5,
                "stable_for_s": 0.4,
                "interval_s": 0.1,
                "timeout_s": 60.0,
            },
        }
    )


def _certificate(model: Model) -> dict[str, float]:
    """Return radiance by level: lamps add up."""
    illumination = model.effect("illumination")
    lamps = illumination.radiance if isinstance(illumination, Illumination) else ()
    return {str(level): total for level, total in enumerate(accumulate(lamps), start=1)}
