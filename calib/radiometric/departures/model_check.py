"""Whether a model's departures may be taken out of a recording."""

from collections.abc import Iterator

from calib.errors import InputError
from calib.forward.departure import Departure
from calib.forward.effects.empirical import Empirical
from calib.forward.model import Model
from calib.radiometric.departures.fitted_chain import carried
from calib.recording.header import RecordingHeader

_SAME = ("columns", "bit_depth", "taps", "tap_layout", "readout")
_SAME_WHERE_KNOWN = ("serial", "band", "line_period_us")


def check_model(model: Model, header: RecordingHeader, *, relative: bool) -> None:
    """Raise InputError unless the model is of this camera and of this scale of radiance.

    Raises:
        InputError: `model-mismatch`, `model-unit`, or `relative-with-model`, for what a model says
            of light is said in its unit of radiance.
    """
    if relative:
        raise InputError(
            "A model's departures cannot be taken out on a relative scale: give the radiances, or "
            "calibrate without the model.",
            code="relative-with-model",
        )
    camera = header.camera
    names = [*_SAME, *(n for n in _SAME_WHERE_KNOWN if _known(model, header, n))]
    if model.camera.rows is not None:
        names.append("rows")
    for name in names:
        modelled, recorded = getattr(model.camera, name), getattr(camera, name)
        if modelled != recorded:
            raise InputError(
                f"The model is of another camera: {name} is {modelled!r} in it and {recorded!r} "
                "in the recording; give the model of this camera.",
                code="model-mismatch",
            )
    if model.source.radiance_unit != header.source.radiance_unit:
        raise InputError(
            f"The model's radiances are in {model.source.radiance_unit!r}, the recording's in "
            f"{header.source.radiance_unit!r}: give both in one unit.",
            code="model-unit",
        )


def model_findings(model: Model) -> Iterator[str]:
    """Yield what an operator should know of the model before the recording is looked at."""
    kept = {e.name for e in carried(model.effects)}
    departures = [e.name for e in model.effects if isinstance(e, Departure | Empirical)]
    if not departures:
        yield "The model holds no departure from the plain response: nothing is corrected for."
    for name in departures:
        if name not in kept:
            yield f"The model's {name} changes single codes or lines, which no correction undoes."


def _known(model: Model, header: RecordingHeader, name: str) -> bool:
    return bool(getattr(model.camera, name)) and bool(getattr(header.camera, name))
