"""What jobs do, in a process of their own: nothing here touches the store.

A kind of work is a function of the request and of `tell`, which takes the share that is done. It
returns plain values. Adding one is one function and one line in `KINDS`.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

Tell = Callable[[float], None]
Work = Callable[[Mapping[str, Any], Tell], dict[str, Any]]


def calibrate(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Calibrate `recording_path` and save the set to `out_path`; return the command's answer.

    The folder of `out_path` is the job's own and is made here.
    """
    from calib.forward.model import Model  # noqa: PLC0415
    from calib.radiometric.calibrate import calibrate as determine  # noqa: PLC0415
    from calib.recording.open import open_recording  # noqa: PLC0415
    from calib.recording.tone import Tone  # noqa: PLC0415

    radiances, tone, out = request["radiances"], request["tone"], Path(request["out_path"])
    out.parent.mkdir()
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
    calibration.coefficients.save(out)
    return calibration.answer()


KINDS: Final[dict[str, Work]] = {"calibrate": calibrate}
