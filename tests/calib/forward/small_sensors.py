"""A line sensor and an area sensor that are drawn in no time."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.conditions import Conditions
from calib.forward.effect import Effect
from calib.forward.effects.offset import Offset
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model

DEMO = Model.preset("demo")
LAMPS = (10.2, 9.9, 10.0, 10.1, 9.8, 10.0)
"""Radiance of each lamp of the demo's sphere."""


def small(rows: int | None, columns: int) -> Model:
    """The demo's camera with one tap, one gain and a lens that fits its size."""
    size = {"rows": rows, "columns": columns, "taps": 1, "tap_layout": "single"}
    camera = DEMO.camera.model_copy(update=size)
    new = (
        Vignette(focal_length_columns=2.0 * columns),
        Responsivity(electrons_per_radiance_us=8.0, prnu_std=0.02),
        SystemGain(dn_per_e=0.15),
    )
    kept = tuple(e for e in DEMO.effects if e.name not in {effect.name for effect in new})
    kept = tuple(
        replace(e, tap_offset_dn=(), tap_layout="single") if isinstance(e, Offset) else e
        for e in kept
    )
    return replace(DEMO, camera=camera, effects=(*kept, *new))


def fitting(model: Model, effect: Effect) -> Model:
    """The sensor with `effect`, and with two taps where it is one of taps."""
    if not effect.name.startswith("tap_"):
        return model.with_effect(effect)
    taps = {"taps": 2, "tap_layout": "odd_even"}
    kept = tuple(
        replace(e, tap_layout="odd_even") if isinstance(e, Offset) else e for e in model.effects
    )
    camera = model.camera.model_copy(update=taps)
    return replace(model, camera=camera, effects=kept).with_effect(effect)


SENSORS = {"line": small(None, 160), "frame": small(12, 14)}
sensors = pytest.mark.parametrize("model", SENSORS.values(), ids=SENSORS)


def at(n_lines: int = 4, **changed: Any) -> Conditions:
    """Three lamps and 50 us, where not told."""
    given = {"exposure_us": 50.0, "line_period_us": 100.0, "lamps": (1.0,) * 3} | changed
    return Conditions.steady(n_lines, **given)


def light_dn(model: Model, conditions: Conditions) -> NDArray[np.float64]:
    """What the chain without noise gives above a capped dark of the plain chain, (n, *sample)."""
    lit = model.draw(conditions, np.random.default_rng(1)).noise_free_dn
    return lit - model.truth().dark_offset_dn


def per_radiance_us(model: Model) -> NDArray[np.float64]:
    truth = model.truth()
    return truth.vignette * truth.responsivity
