"""A camera drawn with NumPy, pixel by pixel, that knows its own truth."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import pearson3

from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader
from calib.transfer.emva1288.block_figures import BlockFigures
from calib.transfer.emva1288.nonuniformity import components, mean_squares
from calib.transfer.emva1288.saturation import SHARE
from tests.calib.radiometric.in_memory import InMemory

Image = NDArray[np.float64]


@dataclass(frozen=True)
class DrawnCamera:
    """Poisson electrons, normal noise, rounding, clipping; patterns of rows, columns and pixels.

    `rows` None is a line sensor. Deviations of `prnu` are relative, those of `dsnu` electrons.
    """

    rows: int | None = 48
    columns: int = 48
    bit_depth: int = 12
    gain: float = 0.25
    read_noise_e: float = 8.0
    offset_dn: float = 60.0
    dark_current_e_per_s: float = 40_000.0
    photons_per_us: float = 250.0
    efficiency: float = 0.6
    bend: float = 0.0  # DN = s (1 − bend s / full scale)
    line_noise_dn: float = 0.0
    prnu: Image = field(default_factory=lambda: np.zeros((1, 1)))
    dsnu: Image = field(default_factory=lambda: np.zeros((1, 1)))

    @property
    def shape(self) -> tuple[int, int]:
        return (self.rows or 1, self.columns)

    @property
    def full_scale_dn(self) -> int:
        return (1 << self.bit_depth) - 1

    def electrons(self, exposure_us: float, level: float) -> Image:
        """Expected electrons of each pixel, dark current included."""
        light = self.efficiency * self.photons_per_us * exposure_us * level
        dark = self.dark_current_e_per_s * exposure_us * 1e-6
        return light * (1.0 + self.prnu) + dark * np.ones(self.shape)

    def expected_dn(self, exposure_us: float, level: float) -> Image:
        """Expected code of each pixel, before rounding and clipping."""
        signal = self.gain * (self.electrons(exposure_us, level) + self.dsnu)
        return self.offset_dn + self._bent(signal)

    def _bent(self, signal: Image) -> Image:
        return signal * (1.0 - self.bend * signal / self.full_scale_dn)

    def draw(self, block: Block, rng: Generator) -> NDArray[np.uint16]:
        n = block.lines or 2
        mean = np.broadcast_to(self.electrons(block.exposure_us, block.level), self.shape)
        e = rng.poisson(mean, (n, *self.shape)).astype(np.float64) + self.dsnu
        e += rng.normal(0.0, self.read_noise_e, e.shape)
        dn = self.offset_dn + self._bent(self.gain * e)
        dn += rng.normal(0.0, self.line_noise_dn, (n, self.shape[0], 1))
        codes = np.clip(np.rint(dn), 0, self.full_scale_dn).astype(np.uint16)
        return codes if self.rows is not None else codes[:, 0, :]

    def record(self, blocks: Sequence[Block], rng: Generator, **source: object) -> InMemory:
        header = RecordingHeader(
            camera=CameraHeader(
                model="drawn", columns=self.columns, rows=self.rows, bit_depth=self.bit_depth
            ),
            source=SourceHeader(
                kind="led", **{"photons_per_pixel_per_us": self.photons_per_us,
                               "wavelength_nm": 530.0, **source},
            ),
            blocks=tuple(blocks),
        )  # fmt: skip
        return InMemory(header, {b.block: (self.draw(b, rng),) for b in blocks})

    def saturation_exposure_us(self) -> float:
        """The exposure at level 1 at which 0.15 % of the samples are at full scale."""

        def share(exposure_us: float) -> float:
            mean, electrons = (f(exposure_us, 1.0) for f in (self.expected_dn, self.electrons))
            variance = self.gain**2 * (electrons + self.read_noise_e**2) + self.line_noise_dn**2
            off = (self.full_scale_dn - 0.5 - mean) / np.sqrt(variance)
            skewness = self.gain**3 * electrons / variance**1.5
            return float(np.mean(pearson3.sf(off, skewness))) - SHARE

        full = self.full_scale_dn / self.gain / self.efficiency / self.photons_per_us
        return float(brentq(share, 0.3 * full, 1.5 * full))

    def spatial_variances(self, exposure_us: float, level: float) -> dict[str, float]:
        """What the highpass and the split make of the expected image: no temporal noise."""
        image = np.broadcast_to(self.expected_dn(exposure_us, level), self.shape)
        block = Block(block="truth", kind="flat", exposure_us=exposure_us)
        quiet = BlockFigures(block, 1, *(0.0,) * 8)
        squares = mean_squares(np.array(image), quiet, filtered=True)
        found = components(np.array(squares.values), squares.shape)
        return {name: float(each) for name, each in found.items()}


def patterned(rng: Generator, camera: DrawnCamera, size: float, lines: float = 0.0) -> Image:
    """A pattern of pixels of this size, with rows and columns of size `lines`."""
    rows, columns = camera.shape
    pattern = rng.normal(0.0, size, (rows, columns))
    return pattern + rng.normal(0.0, lines, (rows, 1)) + rng.normal(0.0, lines, (1, columns))


def sweep(
    exposures_us: Sequence[float], frames: int = 2, stack: int = 16, stack_us: float | None = None
) -> tuple[Block, ...]:
    """Flats and darks at each exposure, and a stack of both for the nonuniformities."""
    return tuple(_blocks(exposures_us, frames, stack, stack_us))


def _blocks(
    exposures_us: Sequence[float], frames: int, stack: int, stack_us: float | None
) -> Iterator[Block]:
    number = 0
    for exposure in exposures_us:
        for kind, level in (("dark", 0.0), ("flat", 1.0)):
            own = stack if exposure == stack_us else frames
            yield Block(block=f"{number:03d}", kind=kind, exposure_us=exposure, level=level,
                        lines=own)  # fmt: skip
            number += 1
