"""From a recording to a coefficient set."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


def calibrate(request: Mapping[str, Any], tell: Callable[[float], None]) -> dict[str, Any]:
    """Calibrate `recording_path` and save the set to `out_path`; return the command's answer."""
    from calib.forward.model import Model  # noqa: PLC0415
    from calib.radiometric.calibrate import calibrate as determine  # noqa: PLC0415
    from calib.recording.open import open_recording  # noqa: PLC0415
    from calib.recording.tone import Tone  # noqa: PLC0415

    radiances, tone = request["radiances"], request["tone"]
    calibration = determine(
        open_recording(Path(request["recording_path"])),
        radiances=radiances and {float(level): value for level, value in radiances.items()},
        relative=request["relative"],
        order=request["order"],
        darks_required=request["darks_required"],
        tone=tone and Tone(**tone),
        model=Model.loads(request["model"]) if request.get("model") else None,
        progress=tell,
    )
    calibration.coefficients.save(Path(request["out_path"]))
    return calibration.answer()
