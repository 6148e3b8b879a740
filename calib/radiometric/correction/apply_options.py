"""How a recording's blocks are to be corrected."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_checks import Validity
from calib.radiometric.correction.transmittance import Window
from calib.recording.header import Block
from calib.recording.protocol import Recording


@dataclass(frozen=True)
class ApplyOptions:
    """How lines are corrected, see `Correction`.

    Attributes:
        window: What the scene was seen through.
        validity: The range for which the set is certified.
        at: When the lines were taken; by the recording's own times where None.
        force: Apply a set that does not match, and say so.
        std: Write the standard uncertainty too.
        blocks: Names of the blocks to correct; all but capped darks where None.
    """

    window: Window | None = None
    validity: Validity | None = None
    at: datetime | None = None
    force: bool = False
    std: bool = True
    blocks: Sequence[str] | None = None

    def correction(
        self,
        recording: Recording,
        block: Block,
        coefficients: CoefficientSet,
        follows: Correction | None = None,
    ) -> Correction:
        """Return the set made ready for one block, which comes behind that of `follows`."""
        camera = recording.header.camera
        at = camera.started_at if self.at is None else self.at
        if at is not None and self.at is None and block.started_s is not None:
            at += timedelta(seconds=block.started_s)
        return Correction(
            coefficients,
            block.exposure_us,
            camera=camera,
            at=at,
            validity=self.validity,
            window=self.window,
            sensor_temperature_c=block.sensor_temperature_c,
            force=self.force,
            follows=follows,
        )
