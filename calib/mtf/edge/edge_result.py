"""What `darkflat mtf` answers and writes of an edge."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from calib.mtf.edge.slanted_edge import EdgeTransfer, Vector, slanted_edge
from calib.mtf.figures_of_merit import PER_MM
from calib.recording import content_addressed

FORMAT = "darkflat edge transfer function 1"


@dataclass(frozen=True)
class EdgeView:
    """How an edge was seen.

    Attributes:
        pitch_um: The pixels' distance, µm.
        direction: "x" along the columns, "y" along the rows.
        moving: Whether rows are lines of a line sensor.
        unknown_keys: Of mtf.toml.
    """

    pitch_um: float
    direction: str = "x"
    moving: bool = False
    unknown_keys: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class EdgeResult:
    """A transfer function in one direction, with its figures of merit.

    Attributes:
        image: The edge, across the columns.
        view: How it was seen.
    """

    image: Vector
    view: EdgeView

    @cached_property
    def found(self) -> EdgeTransfer:
        """The transfer function."""
        return slanted_edge(self.image, self.view.pitch_um, moving=self.view.moving)

    @property
    def first_zero(self) -> tuple[float | None, float | None]:
        """Where the real part first changes its sign, per mm, and its std; None without one."""
        real, frequency = self.found.transfer.real, PER_MM * self.found.frequency_per_um
        crossing = np.flatnonzero((real[:-1] > 0) & (real[1:] <= 0))
        if not len(crossing):
            return None, None
        k = int(crossing[0])
        slope = (real[k + 1] - real[k]) / (frequency[k + 1] - frequency[k])
        return float(frequency[k] - real[k] / slope), float(abs(self.found.std[k] / slope))

    def answer(self) -> dict[str, Any]:
        """Return the answer of contract §6; what one direction does not tell is None."""
        zero, zero_std = self.first_zero
        at = int(np.argmin(np.abs(self.found.frequency_per_um - 0.5 / self.view.pitch_um)))
        value = float(np.abs(self.found.transfer[at]))
        along = {"x": 0, "y": 1}[self.view.direction]
        return {
            "transfer_function": content_addressed.content_id(self._arrays, self._metadata),
            "method": "slanted edge",
            "first_zero_per_mm": [zero if along == k else None for k in (0, 1)],
            "first_zero_std_per_mm": [zero_std if along == k else None for k in (0, 1)],
            "mtf_at_nyquist": {
                "x": value if along == 0 else None,
                "y": value if along == 1 else None,
                "std": float(self.found.std[at]),
            },
            "grating_shift_um": None,
            "mean_transfer_std": float(self.found.std.mean()),
            "edge_angle_deg": float(np.degrees(self.found.angle_rad)),
            "warnings": [f"mtf.toml: unknown key {key} is left out" for key in self._unknown],
        }

    def save(self, path: Path) -> None:
        """Write the file, whole or not at all."""
        content_addressed.write(path, self._arrays, self._metadata)

    @property
    def _unknown(self) -> tuple[str, ...]:
        return self.view.unknown_keys

    @property
    def _arrays(self) -> dict[str, Any]:
        return {
            "frequency_per_mm": PER_MM * self.found.frequency_per_um,
            "transfer": self.found.transfer,
            "transfer_std": self.found.std,
            "valid": np.ones(len(self.found.std), bool),
            "line_spread": self.found.line_spread,
            "position_um": self.found.position_um,
        }

    @property
    def _metadata(self) -> dict[str, Any]:
        return {
            "format": FORMAT,
            "pitch_um": self.view.pitch_um,
            "direction": self.view.direction,
            "moving": self.view.moving,
        }
