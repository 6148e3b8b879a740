"""Whether a given model can be held against a recording at all: pixel by pixel."""

from calib.errors import InputError
from calib.forward.model import Model
from calib.recording.header import CameraHeader


def check_size(given: Model, camera: CameraHeader) -> None:
    """Raise InputError `model-mismatch` unless the model has the recording's pixels."""
    for name in ("columns", "rows"):
        modelled, recorded = getattr(given.camera, name), getattr(camera, name)
        if modelled != recorded:
            raise InputError(
                f"The model is of another camera: {name} is {modelled} in it and {recorded} in the "
                "recording; give the model of this camera as it was read out.",
                code="model-mismatch",
            )
