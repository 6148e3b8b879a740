"""What one draw of the forward model gives."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.arrays import Lines, RawLines
from calib.forward.chain import ExpectedElectrons, run, without_noise
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.left import Left


@dataclass(frozen=True)
class Drawn:
    """Lines as a camera sends them, and on request what they were drawn from.

    Attributes:
        dn: Codes, (n_lines, *sample); uint8 at 8 bits, else uint16.
        left: What the lines leave in the pixels; None where the model has no memory.
    """

    dn: RawLines
    left: Left | None = field(repr=False)
    _effects: tuple[Effect, ...] = field(repr=False)
    _scene: Lines = field(repr=False)
    _at: Conditions = field(repr=False)
    _expected: ExpectedElectrons = field(repr=False)

    @cached_property
    def electrons(self) -> NDArray[np.float64]:
        """Expected electrons before shot noise, (n_lines, *sample), dark charge included."""
        return self._expected.by_line()

    @cached_property
    def noise_free_dn(self) -> NDArray[np.float64]:
        """DN without the links that draw random numbers, (n_lines, *sample).

        Neither rounded nor clipped to codes: it ends before the stage of the codes. It is the
        mean DN wherever the chain is linear and nothing clips.
        """
        links = without_noise(e for e in self._effects if e.stage < Stage.CODES)
        scene = np.broadcast_to(self._scene, self.dn.shape)
        return np.asarray(run(links, scene, self._at, default_rng(0)), np.float64)


def as_codes(signal: Lines, bit_depth: int) -> RawLines:
    """Return whole, clipped codes in the smallest type that holds them."""
    return signal.astype(np.uint8) if bit_depth == 8 else signal.astype(np.uint16)
