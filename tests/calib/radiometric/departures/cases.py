"""Every departure that touches radiance, on one small camera, and what its scenes look like."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.forward.departure import Departure
from calib.forward.effect import Effect, Stage
from calib.forward.effects.catalogue import effect_named
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.blocks_to_correct import corrections_by_block
from calib.recording.header import Block, RecordingHeader
from tests.calib.radiometric.in_memory import InMemory, agcam_plan, record
from tests.calib.radiometric.small_camera import small_camera

COLUMNS = 128
LINES = 64
PATTERN_LINES = 8
TEMPERATURES_C = (25.0, 27.0, 24.0, 29.0, 26.0, 28.0)
SCENES = ((100.0, 25.0), (200.0, 29.0))
"""Exposure, µs, and sensor temperature, °C."""

_PLAIN = small_camera(COLUMNS, axis_column=70.0)
_TAPS = {"taps": 2, "tap_layout": "odd_even", "started_at": datetime(2026, 11, 1, tzinfo=UTC)}
_WITHOUT_ERROR = {"certificate_relative_std": 0.0, "level_relative_std": 0.0}
MODEL = Model(
    _PLAIN.camera.model_copy(update=_TAPS),
    _PLAIN.source.model_copy(update=_WITHOUT_ERROR),
    _PLAIN.effects,
)


@dataclass(frozen=True)
class Case:
    """A departure, and what of it a fit is to find."""

    effect: Effect
    fitted: tuple[str, ...] = ()
    """Empty where the plain estimation takes it off by itself, as a dark current."""
    by_covariance: bool = False
    """Means of uniform light do not show it."""

    @property
    def name(self) -> str:
        return self.effect.name

    @property
    def model(self) -> Model:
        return MODEL.with_effect(self.effect)

    def with_values(self, values: Sequence[float]) -> Model:
        """The model with these values of the fitted parameters; of a tuple's, the last one."""
        told = {}
        for name, value in zip(self.fitted, map(float, values), strict=True):
            known = getattr(self.effect, name)
            told[name] = (*known[:-1], value) if isinstance(known, tuple) else value
        return MODEL.with_effect(replace(self.effect, **told))

    @property
    def true_values(self) -> tuple[float, ...]:
        """What a fit should find."""
        known = (getattr(self.effect, name) for name in self.fitted)
        return tuple(k[-1] if isinstance(k, tuple) else k for k in known)


def _case(name: str, *fitted: str, by_covariance: bool = False, **values: object) -> Case:
    return Case(effect_named(name)(**values), fitted, by_covariance)


_SETTLING = {"time_constant_s": 0.5}
CASES = (
    _case("lamp_drift", "amplitude", "time_constant_s", amplitude=0.03, **_SETTLING),
    _case("level_nonadditivity", "loss_per_lamp", loss_per_lamp=0.005),
    _case("stray_light", "radiance", radiance=0.3),
    _case("exposure_offset", "offset_us", offset_us=1.0),
    _case("reciprocity_failure", "exponent", exponent=0.01),
    _case("dark_current", electrons_per_us=0.3, dsnu_std_e_per_us=0.03),
    _case(
        "dark_current_temperature", "electrons_per_us", electrons_per_us=1.0, dsnu_std_e_per_us=0.1
    ),
    _case("hot_pixels", share=0.03),
    _case("amplifier_glow", electrons_per_us=0.5, decay_columns=30.0),
    _case("saturation_knee", "threshold_e", "room_e", threshold_e=30_000.0, room_e=60_000.0),
    _case("brighter_fatter", "row_per_e", by_covariance=True, row_per_e=1e-6),
    _case("lag", "share", share=0.02),
    _case("persistence", "share", "time_constant_s", share=0.02, time_constant_s=0.5),
    _case("cti", "per_transfer", by_covariance=True, per_transfer=2e-4, partition_noise=0.0),
    _case("interpixel_capacitance", "column_coupling", by_covariance=True, column_coupling=0.02),
    _case("tap_crosstalk", "fraction", by_covariance=True, fraction=0.01),
    _case("tap_gain_drift", "amplitude", "time_constant_s", amplitude=(0.0, 0.02), **_SETTLING),
    _case("gain_drift", "amplitude", "time_constant_s", amplitude=0.03, **_SETTLING),
    _case("nonlinearity", "beta_per_dn", beta_per_dn=1e-5),
    _case("offset_drift", "amplitude_dn", "time_constant_s", amplitude_dn=10.0, **_SETTLING),
    _case("offset_temperature", "dn_per_k", dn_per_k=1.0),
    _case("adc_inl", "s_dn", "w_dn", s_dn=4.0),
)


def recording(model: Model, rng: Generator, lines: int = LINES) -> InMemory:
    """The paper's two sweeps and darks, the sensor's temperature changing from block to block."""
    blocks = [
        b.model_copy(update={"sensor_temperature_c": TEMPERATURES_C[k % len(TEMPERATURES_C)]})
        for k, b in enumerate(agcam_plan(lines))
    ]
    return record(model, blocks, rng, lines)


def scene_radiance(n_lines: int) -> NDArray[np.float64]:
    """Bars along the line, four bright lines and four dim ones in turn, (n_lines, COLUMNS)."""
    bars = np.where((np.arange(COLUMNS) // 7) % 2, 0.45, 1.0)
    steps = np.where((np.arange(n_lines) // (PATTERN_LINES // 2)) % 2, 0.3, 1.0)
    return np.asarray(18.0 * steps[:, None] * bars)


def scenes(model: Model, rng: Generator, n_lines: int) -> InMemory:
    """The same camera in front of a scene: what the bench's source does, it does not see there."""
    seen = [e for e in model.effects if not _of_the_bench(e)]
    camera = Model(model.camera, model.source, tuple(seen))
    blocks = [
        Block(
            block=f"s{k}", kind="scene", exposure_us=t, level=0, lines=n_lines, scene="x",
            sensor_temperature_c=temperature_c,
        )
        for k, (t, temperature_c) in enumerate(SCENES)
    ]  # fmt: skip
    image = {"x": scene_radiance(n_lines)}
    drawn = [
        (b, tuple(frames))
        for b, frames in simulate(camera, blocks, rng, frame_lines=n_lines, scenes=image)
    ]
    header = RecordingHeader(
        camera=model.camera, source=model.source, blocks=tuple(b for b, _ in drawn)
    )
    return InMemory(header, {b.block: frames for b, frames in drawn})


def _of_the_bench(effect: Effect) -> bool:
    return isinstance(effect, Departure) and effect.stage == Stage.SOURCE


def radiance_error(coefficients: CoefficientSet, seen: InMemory) -> float:
    """Root mean square of the relative error of radiance by phase of the pattern and column, %.

    Noise is averaged over the pattern's repetitions, the first of which is left out. So are columns
    that the set masks.
    """
    squares = []
    every = corrections_by_block(seen, coefficients, ApplyOptions(), seen.header.blocks)
    for name, correction in every.items():
        found = np.concatenate([correction.lines(dn).radiance for dn in seen.frames(name)])
        relative = found.astype(np.float64) / scene_radiance(len(found))
        mean = relative.reshape(-1, PATTERN_LINES, COLUMNS)[1:].mean(axis=0)
        squares.append(np.nanmean((mean - 1.0) ** 2))
    return float(100.0 * np.sqrt(np.mean(squares)))
