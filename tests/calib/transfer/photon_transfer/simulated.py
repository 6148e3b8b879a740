"""Recordings of a line sensor drawn with NumPy alone: straight, with a bent response, or with
charge that repels what comes next."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.recording.digest import digest_of
from calib.recording.header import Block, CameraHeader, RecordingHeader

Kind = Literal["straight", "nonlinear", "brighter_fatter"]
GAIN, READ_DN, OFFSET_DN, TOP_DN = 0.25, 3.0, 100.0, 3600.0
BETA_PER_DN = 2e-5
A_PER_E = np.array([-4e-6, 1.4e-6, 0.6e-6])
"""a00, a01, a02; with both sides they add up to 0, as no charge is lost."""
SHARES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
UNREST = 3e-4
_STEPS = 16


@dataclass(frozen=True)
class Held:
    """`Recording` without a file."""

    header: RecordingHeader
    stretches: dict[str, tuple[RawLines, ...]]
    path: Path = Path("in-memory")
    warnings: tuple[str, ...] = ()

    def frames(self, block: str) -> Iterator[RawLines]:
        yield from self.stretches[block]

    def digest(self) -> str:
        return digest_of(self)


def electrons(
    expected: NDArray[np.float64], rng: Generator, a_per_e: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Poisson electrons, (n_lines, n_columns); with `a_per_e` in steps, each pixel's area changed
    by a[|i − j|] per electron that pixel j has gathered."""
    if a_per_e is None:
        return rng.poisson(expected).astype(np.float64)
    gathered = np.zeros(expected.shape)
    for _ in range(_STEPS):
        area = 1.0 + a_per_e[0] * gathered
        for j in range(1, len(a_per_e)):
            area[:, j:] += a_per_e[j] * gathered[:, :-j]
            area[:, :-j] += a_per_e[j] * gathered[:, j:]
        gathered += rng.poisson(expected / _STEPS * area)
    return gathered


def recording(
    kind: Kind, lines: int, columns: int, rng: Generator, shares: tuple[float, ...] = SHARES
) -> Held:
    """Ten flats of one level and two darks; the source is unsteady by 3e-4 from block to block."""
    profile = np.linspace(0.8, 1.0, columns) * (1.0 + 0.01 * rng.standard_normal(columns))
    beta = BETA_PER_DN if kind == "nonlinear" else 0.0
    a_per_e = A_PER_E if kind == "brighter_fatter" else None
    blocks, frames = [], {}
    for share, is_dark in [*((s, False) for s in shares), (shares[0], True), (shares[-1], True)]:
        light = 0.0 if is_dark else share * (1.0 + UNREST * rng.standard_normal())
        expected = np.broadcast_to(TOP_DN / GAIN * light * profile, (lines, columns))
        charge = electrons(expected, rng, None if is_dark else a_per_e)
        volts = GAIN * charge + READ_DN * rng.standard_normal(charge.shape)
        codes = np.rint(volts * (1.0 - beta * volts) + OFFSET_DN)
        block = Block(
            block=f"{len(blocks):03d}",
            kind="dark" if is_dark else "flat",
            exposure_us=1000.0 * share,
            level=0.0 if is_dark else 1.0,
            lines=lines,
        )
        blocks.append(block)
        frames[block.block] = (np.clip(codes, 0, 4095).astype(np.uint16),)
    camera = CameraHeader(columns=columns, bit_depth=12)
    return Held(RecordingHeader(camera=camera, blocks=tuple(blocks)), frames)
