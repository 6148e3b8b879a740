"""Plans that determine a whole coefficient set: every exposure at every level, darks between."""

from collections.abc import Sequence
from itertools import accumulate
from typing import Any

from calib.forward.model import Model
from service.plan.model import Plan


def whole_sweep(
    model: Model, exposures_us: Sequence[float], levels: Sequence[int], **plan: Any
) -> Plan:
    """Return a level-major sweep with a dark before each level and one at the end.

    The radiances are those of `model`. `plan` is what the plan says beside that.
    """
    blocks: list[dict[str, Any]] = []
    for k, level in enumerate([*levels, levels[-1]]):
        dark_us = exposures_us[k % len(exposures_us)]
        blocks.append({"kind": "dark", "exposure_us": dark_us, "level": level})
        if k < len(levels):
            blocks += [{"exposure_us": each, "level": level} for each in exposures_us]
    camera = model.camera
    radiances = accumulate(model.effect("illumination").radiance)
    return Plan.parse(
        {
            "sweep": {"type": "listed", "blocks": blocks},
            "camera": {
                "line_period_us": camera.line_period_us,
                "pixel_format": f"Mono{camera.bit_depth}",
                "taps": camera.taps,
                "tap_layout": camera.tap_layout,
                "columns": plan.pop("columns", None),
            },
            "source": {"radiance": {str(n): total for n, total in enumerate(radiances, start=1)}},
            **plan,
        }
    )
