"""What is measured first where nobody gives a plan: darks, and flats at three levels at most."""

from typing import Any

from calib.errors import InputError
from calib.forward.effects.illumination import Illumination
from calib.forward.model import Model
from service.bench.bench import Bench
from service.plan.model import Plan

_LINES = 256
_MOST_LEVELS = 3
_EXPOSURES = (0.1, 0.25, 0.5)
"""Of the line period, or of what the brightest level leaves of full scale, whichever is less."""
_FILLED = 0.8
"""Of full scale, by the longest exposure at the highest level."""


def first_plan(bench: Bench) -> Plan:
    """Return a plan for a simulated bench; InputError where only a person knows the camera."""
    if bench.simulated is None:
        raise InputError(
            f"bench {bench.id!r} is no simulation, and nobody knows its camera's line period: "
            "give the first sweep by --plan",
            code="plan-needed",
        )
    model = bench.simulated.model()
    levels = range(1, min(_MOST_LEVELS, int(bench.light.max_level)) + 1)
    longest_us = min(_longest_us(model, len(levels)), model.camera.line_period_us or 1000.0)
    exposures = [round(longest_us * share / _EXPOSURES[-1], 1) for share in _EXPOSURES]
    return Plan.parse(
        {
            "name": "first sweep",
            "lines": _LINES,
            "order": "level_major",
            "sweep": {"type": "factorial", "exposures_us": exposures, "levels": list(levels)},
            "camera": _camera(model),
            "source": {"lamps": int(bench.light.max_level), "radiance": _radiance(model)},
            "settle": {
                "tolerance_percent": 0.5, "stable_for_s": 0.5, "interval_s": 0.1, "timeout_s": 60.0,
                "without_monitor_s": 1.0,
            },
            "saturation": {"action": "skip"},
        }
    )  # fmt: skip


def _longest_us(model: Model, level: int) -> float:
    """Return the exposure with which `level` lamps fill what they may of full scale."""
    truth = model.truth()
    slope = float((truth.responsivity * truth.vignette).max()) * _lamps(model)[level - 1]
    room = _FILLED * model.camera.full_scale_dn - float(truth.dark_offset_dn.mean())
    return room / max(slope, 1e-12)


def _lamps(model: Model) -> list[float]:
    """Return the radiance of the first 1, 2, 3 ... lamps."""
    illumination = model.effect("illumination")
    lamps = illumination.radiance if isinstance(illumination, Illumination) else (1.0,)
    return [sum(lamps[:n]) for n in range(1, len(lamps) + 1)]


def _radiance(model: Model) -> dict[str, float]:
    return {str(n): total for n, total in enumerate(_lamps(model), start=1)}


def _camera(model: Model) -> dict[str, Any]:
    camera = model.camera
    return {
        "line_period_us": camera.line_period_us, "pixel_format": f"Mono{camera.bit_depth}",
        "band": camera.band, "taps": camera.taps, "tap_layout": camera.tap_layout,
    }  # fmt: skip
