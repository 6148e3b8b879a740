"""A camera, its sweep up to saturation, and what is true of both."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from calib.recording.header import Block
from calib.transfer.emva1288.formulas import QUANTISATION_DN2, relative_line
from tests.calib.radiometric.in_memory import InMemory
from tests.calib.transfer.emva1288.drawn_camera import DrawnCamera, patterned, sweep

SHARES = (0.03, 0.08, 0.2, 0.35, 0.5, 0.65, 0.8, 0.92, 0.985, 1.06)
HALF = 4


@dataclass(frozen=True)
class Bench:
    """A camera with its patterns, and the exposures of its sweep in shares of saturation's."""

    camera: DrawnCamera
    saturation_us: float
    exposures_us: tuple[float, ...]

    def blocks(self, frames: int = 2, stack: int = 16) -> tuple[Block, ...]:
        return sweep(self.exposures_us, frames, stack, self.exposures_us[HALF])

    def record(
        self, rng: Generator, frames: int = 2, stack: int = 16, **source: object
    ) -> InMemory:
        return self.camera.record(self.blocks(frames, stack), rng, **source)

    def signal(self, exposure_us: float) -> float:
        """Mean signal above dark, DN."""
        lit, dark = (self.camera.expected_dn(exposure_us, level) for level in (1.0, 0.0))
        return float(np.mean(lit - dark))

    def truth(self) -> dict[str, float]:
        """What the linear model's figures are, of these pixels."""
        c, half = self.camera, self.exposures_us[HALF]
        lit = 1.0 + float(np.mean(c.prnu))
        dark = (c.gain * c.read_noise_e) ** 2 + c.line_noise_dn**2
        electrons = self.signal(self.saturation_us) / c.gain
        least = np.sqrt((dark + QUANTISATION_DN2) / c.gain**2 + 0.25) + 0.5
        flat, capped = c.spatial_variances(half, 1.0), c.spatial_variances(half, 0.0)
        known = {
            "system_gain_dn_per_e": c.gain,
            "temporal_dark_noise_dn": np.sqrt(dark + QUANTISATION_DN2),
            "read_noise_e": np.sqrt(dark) / c.gain,
            "responsivity_dn_per_photon": c.gain * c.efficiency * lit,
            "quantum_efficiency": c.efficiency * lit,
            "saturation_dn": float(np.mean(c.expected_dn(self.saturation_us, 1.0))),
            "saturation_capacity_e": electrons,
            "saturation_capacity_photons": self.saturation_us * c.photons_per_us,
            "sensitivity_threshold_e": least,
            "snr_max_db": 10.0 * np.log10(electrons),
            "dynamic_range": electrons / least,
            "dark_current_mean_dn_per_s": c.gain * c.dark_current_e_per_s,
            "dark_current_mean_e_per_s": c.dark_current_e_per_s,
            "dark_current_variance_e_per_s": c.dark_current_e_per_s,
        }
        for name in capped:
            tail = "" if name == "total" else f"_{name}"
            known[f"dsnu{tail}_e"] = np.sqrt(capped[name]) / c.gain
            excess = flat[name] - capped[name]
            known[f"prnu{tail}_percent"] = 100.0 * np.sqrt(excess) / self.signal(half)
        return known

    def linearity_error(self) -> float:
        """LE of the expected codes, percent."""
        top = self.signal(self.saturation_us)
        light = np.array([t for t in self.exposures_us if 0.05 <= self.signal(t) / top <= 0.95])
        signal = np.array([self.signal(t) for t in light])
        offset, slope = relative_line(light, signal)
        line = offset + slope * light
        return float(np.mean(np.abs(100.0 * (signal - line) / line)))


def bench(
    rng: Generator,
    camera: DrawnCamera | None = None,
    shares: Sequence[float] = SHARES,
    lines: float = 0.4,
) -> Bench:
    """Give a camera 1 % PRNU and 10 e- DSNU, rows and columns `lines` times as much."""
    camera = camera or DrawnCamera()
    lines = lines if camera.rows else 0.0
    prnu = patterned(rng, camera, 0.01, 0.01 * lines)
    made = replace(camera, prnu=prnu, dsnu=patterned(rng, camera, 10.0, 10.0 * lines))
    full = made.saturation_exposure_us()
    return Bench(made, full, tuple(round(full * share, 3) for share in shares))
