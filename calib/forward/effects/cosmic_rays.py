"""Cosmic rays: a particle leaves charge along its track, in one line only.

Source: Groom, Cosmic rays and other nonsense in astronomical CCD imagers, Experimental Astronomy
14, 45 (2002): at sea level one to two events per cm^2 and minute, most of them straight tracks of
muons; 3e-8 per second in a pixel of 10 um. Energy loss: Moyal, Theory of ionization fluctuations,
Phil. Mag. 46, 263 (1955), which approximates Landau's law; a muon frees about 80 electrons per um
of silicon (Janesick, 2001). The width is that of 10 to 20 um of silicon, where the full width at
half maximum is near half of the most probable loss (Bichsel, Rev. Mod. Phys. 60, 663 (1988)).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import lines
from calib.recording.header import Block, CameraHeader

_RELATIVE_SCALE = 0.14
"""Moyal's scale over the most probable loss; his full width at half maximum is 3.59 scales."""


@dataclass(frozen=True)
class CosmicRays(Departure):
    """Add the charge of tracks that begin at random, as many as rate x pixels x exposure.

    A track is straight and crosses `length` pixels, geometrically distributed, along the line or
    in any direction over a frame; what lies beyond the sensor is lost. Each pixel crossed gains
    electrons (1 - 0.14 ln z^2), z normal, its own draw of Moyal's law.

    Attributes:
        per_pixel_s: Tracks that begin in a pixel per second of exposure.
        electrons: Most probable charge left in a pixel.
        length_pixels: Mean number of pixels that a track crosses.
    """

    name: ClassVar[str] = "cosmic_rays"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Particles leave short tracks of charge in single lines, in proportion to the exposure."
    )
    shows_in: ClassVar[Statistic] = "tail"
    depends_on: ClassVar[tuple[Variable, ...]] = ("exposure", "line", "column")

    per_pixel_s: float = parameter(1e-3, unit="1/s", low=0.0, high=1e4, neutral=0.0)
    electrons: float = parameter(1000.0, unit="e-", low=0.0, high=1e6)
    length_pixels: float = parameter(2.0, unit="pixel", low=1.0, high=1e3)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Electrons in and out, (n_lines, *sample)."""
        charge = np.array(signal, dtype=np.float64)
        n_tracks = int(rng.poisson(self.per_pixel_s * at.exposure_us * 1e-6 * signal.size))
        start = np.array([rng.integers(0, n, n_tracks) for n in signal.shape]).T
        step = _directions(rng, n_tracks, signal.ndim)
        length = rng.geometric(1 / self.length_pixels, n_tracks)
        for k in range(int(length.max(initial=0))):
            going = length > k
            where = np.rint(start[going] + k * step[going]).astype(np.intp)
            inside = np.all((where >= 0) & (where < signal.shape), axis=1)
            z = rng.standard_normal(int(inside.sum()))
            left = self.electrons * (1.0 - _RELATIVE_SCALE * np.log(z * z))
            np.add.at(charge, tuple(where[inside].T), np.maximum(left, 0.0))
        return charge

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: lines to stand out from."""
        return lines(blocks, 3)


def _directions(rng: Generator, n: int, n_axes: int) -> NDArray[np.float64]:
    """Return the step from pixel to next pixel, (n, n_axes); none leaves its line or frame."""
    step = np.zeros((n, n_axes))
    if n_axes == 2:
        step[:, -1] = rng.choice((-1.0, 1.0), n)
    else:
        angle = rng.uniform(0.0, 2 * np.pi, n)
        along = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        step[:, -2:] = along / np.abs(along).max(axis=1, keepdims=True)
    return step
