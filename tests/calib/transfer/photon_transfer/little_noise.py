"""Recordings of an 8-bit line sensor whose noise is below a DN, as AgCam's, drawn with NumPy alone.

Offsets spread over more than a code, as theirs do; exposures and levels are AgCam's.
"""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from calib.recording.header import Block, CameraHeader, RecordingHeader
from tests.calib.transfer.photon_transfer.simulated import Held

SWEEP_US = (100.0, 200.0, 300.0, 400.0, 500.0)


@dataclass(frozen=True)
class EightBits:
    """The truth; `read_dn` is the noise before rounding."""

    read_dn: float
    gain: float = 0.0035
    offset_dn: float = 6.0
    offset_std_dn: float = 0.95
    columns: int = 384
    lines: int = 64
    profile_low: float = 0.75
    unrest: float = 3e-4

    def recording(self, rng: Generator) -> Held:
        """Five flats and five darks at one level, five more flats at one exposure."""
        n = self.columns
        offset = self.offset_dn + self.offset_std_dn * rng.standard_normal(n)
        profile = np.linspace(self.profile_low, 1.0, n) * (1.0 + 0.03 * rng.standard_normal(n))
        plan = [("flat", t, 1) for t in SWEEP_US] + [("dark", t, 0) for t in SWEEP_US]
        plan += [("flat", 100.0, level) for level in (1, 2, 3, 4, 5)]
        blocks, frames = [], {}
        for k, (kind, exposure, level) in enumerate(plan):
            light = level * exposure * (1.0 + self.unrest * rng.standard_normal())
            expected = np.broadcast_to(0.4 * light * profile / self.gain, (self.lines, n))
            volts = self.gain * rng.poisson(expected)
            volts = volts + offset + self.read_dn * rng.standard_normal(volts.shape)
            name = f"{k:03d}"
            blocks.append(
                Block(block=name, kind=kind, exposure_us=exposure, level=level, lines=self.lines)
            )
            frames[name] = (np.clip(np.rint(volts), 0, 255).astype(np.uint8),)
        camera = CameraHeader(columns=n, bit_depth=8)
        return Held(RecordingHeader(camera=camera, blocks=tuple(blocks)), frames)
