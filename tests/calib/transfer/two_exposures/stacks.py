"""Two exposures of a simulated sensor, as moments and as a recording."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.noise import draw_codes
from calib.kernels.pixel_moments import PixelAccumulator
from calib.kernels.pooled_sums import ALL_TAPS
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.transfer.two_exposures.exposure_pair import ExposureMoments, ExposurePair
from calib.transfer.two_exposures.frame_series import BlockSeries, FrameSeries
from calib.transfer.two_exposures.pooled import PooledEstimates, pooled
from calib.transfer.two_exposures.tap_sums import TapSums
from calib.transfer.two_exposures.weights import weights
from tests.calib.radiometric.in_memory import InMemory

FULL_SCALE_DN = 65535
Values = NDArray[np.float64]


@dataclass(frozen=True)
class Sensor:
    """Pixels in a row; read noise is of one number of electrons."""

    gain: Values
    bias: Values
    electrons: Values
    read_e: float
    full_scale_dn: int = FULL_SCALE_DN

    @classmethod
    def flat(
        cls, n_pixels: int, electrons: float, read_e: float, gain: float = 1.0, spread: float = 0.0
    ) -> "Sensor":
        """Alike, or with gains that differ by `spread` (relative, normal), always the same."""
        rng = np.random.default_rng(n_pixels)
        gains = gain * (1.0 + spread * rng.standard_normal(n_pixels))
        bias = 100.0 + rng.standard_normal(n_pixels)
        return cls(gains, bias, np.full(n_pixels, electrons), read_e)

    @property
    def read_noise_dn2(self) -> Values:
        return np.asarray((self.gain * self.read_e) ** 2)

    def frames(self, n: int, key: int, light: Values | float = 1.0) -> RawLines:
        """Draw n frames, (n, n_pixels); `light` scales the electrons, for all or by frame."""
        return draw_codes(
            self.electrons[None],
            np.broadcast_to(light, n).copy(),
            np.zeros(self.gain.size),
            read_std_e=self.read_e,
            gain_dn_per_e=self.gain,
            offset_dn=self.bias,
            full_scale_dn=self.full_scale_dn,
            full_well_e=np.inf,
            key=key,
        )


def accumulated(dn: RawLines, full_scale_dn: int = FULL_SCALE_DN) -> PixelAccumulator:
    accumulator = PixelAccumulator(np.zeros(dn.shape[1], np.uint8), full_scale_dn)
    accumulator.add(dn)
    return accumulator


def pair_of(first: RawLines, second: RawLines, ratio: float = 2.0) -> ExposurePair:
    one, two = (ExposureMoments.of(accumulated(dn).sums) for dn in (first, second))
    return ExposurePair(one, two, ratio)


def drawn_pair(sensor: Sensor, n: int, key: int) -> ExposurePair:
    return pair_of(sensor.frames(n, 2 * key), sensor.frames(n, 2 * key + 1, 2.0))


def pooled_of(first: RawLines, second: RawLines, **options: Any) -> PooledEstimates:
    """Pooled over all pixels of both exposures' frames."""
    done = [accumulated(dn) for dn in (first, second)]
    n_pixels = first.shape[1]
    blocks = [BlockSeries("", a.frame_sums, a.chunk_sizes, a.chunk_squares) for a in done]
    series = [FrameSeries.of([b], np.array([n_pixels]), [0]) for b in blocks]
    one, two = (ExposureMoments.of(a.sums) for a in done)
    pair = ExposurePair(one, two)
    of_pixels = weights(pair, pair.unclipped, (n_pixels,))
    sums = TapSums.of(pair, of_pixels, np.zeros(n_pixels, np.uint8))
    return pooled(sums, ALL_TAPS, series, **options)


@dataclass(frozen=True)
class Shot:
    """One block of a recording to be."""

    frames: RawLines
    exposure_us: float
    kind: str = "flat"
    level: float = 1.0
    more: dict[str, Any] = field(default_factory=dict)


def recording_of(
    shots: Sequence[Shot], *, bit_depth: int = 16, stretch: int = 1, **camera: Any
) -> InMemory:
    """Return the blocks, in the order given, read in stretches of so many frames."""
    blocks: list[Block] = []
    stretches: dict[str, tuple[RawLines, ...]] = {}
    for number, shot in enumerate(shots):
        name, dn = f"{number:03d}", shot.frames
        level = 0.0 if shot.kind == "dark" else shot.level
        what: dict[str, Any] = {"block": name, "kind": shot.kind, "exposure_us": shot.exposure_us}
        blocks.append(Block(**what, level=level, lines=len(dn), **shot.more))
        stretches[name] = tuple(dn[k : k + stretch] for k in range(0, len(dn), stretch))
    shape = shots[0].frames.shape
    rows = shape[1] if len(shape) == 3 else None
    header = RecordingHeader(
        camera=CameraHeader(columns=shape[-1], rows=rows, bit_depth=bit_depth, **camera),
        blocks=tuple(blocks),
    )
    return InMemory(header, stretches)
