"""How far the radiance by the plain calibration is off; `radiance_check` says what is meant."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TOUCHED = 5e-4
"""An error that is smaller everywhere is none."""


@dataclass(frozen=True)
class RadianceError:
    """Relative error of the radiance by the plain calibration, one entry per flat, (n_flats,).

    Attributes:
        blocks: Names of the flats.
        signal_dn: Mean signal.
        error: Median over the pixels.
        low, high: Between which nine pixels in ten lie.
        left_std: What the fitted parameters leave unsure of it, root mean square over pixels.
    """

    blocks: tuple[str, ...]
    signal_dn: Floats
    error: Floats
    low: Floats
    high: Floats
    left_std: Floats

    @property
    def worst(self) -> int:
        """The flat with the largest error."""
        return int(np.argmax(np.abs(self.error)))

    @property
    def touched(self) -> bool:
        """Whether radiance is off at all."""
        return bool(np.abs(self.error).max() > max(TOUCHED, 2.0 * self.left_std[self.worst]))

    @property
    def text(self) -> str:
        """Return a sentence for an operator."""
        if not self.touched:
            return "The radiance of uniform light is not touched."
        error = float(self.error[self.worst])
        way = "high" if error > 0 else "low"
        return (
            f"Radiance by the plain calibration is up to {100 * abs(error):.2g} % too {way}, at a "
            f"signal of {self.signal_dn[self.worst]:.0f} DN."
        )

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "blocks": list(self.blocks),
            "signal_dn": self.signal_dn.tolist(),
            "relative_error": self.error.tolist(),
            "left_std": self.left_std.tolist(),
            "text": self.text,
        }
