"""What a coefficient set made of raw lines."""

import json
from dataclasses import dataclass
from typing import IO, Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class AppliedLines:
    """Radiance, as it came back.

    Attributes:
        radiance: (n_lines, n_columns) in `radiance_unit`.
        std: Its standard uncertainty, likewise.
        flags: A bit for each thing a reader has to know of a sample (`calib...flags.Flag`).
        radiance_unit: Of both.
        coefficient_set: The set's id.
        notes: What was assumed, forced or extrapolated.
    """

    radiance: NDArray[np.float32]
    std: NDArray[np.float32]
    flags: NDArray[np.uint8]
    radiance_unit: str
    coefficient_set: str
    notes: tuple[str, ...]

    @classmethod
    def read(cls, archive: IO[bytes]) -> Self:
        """Read the .npz that the service sends."""
        with np.load(archive, allow_pickle=False) as found:
            about = json.loads(found["notes.json"])
            return cls(
                found["radiance"],
                found["std"],
                found["flags"],
                about["radiance_unit"],
                about["coefficient_set"],
                tuple(about["notes"]),
            )
