"""`/v1/calibrations`: from a recording to a coefficient set, as a job.

Radiances computed from spectra of the lamps and of the camera belong to the command line alone
(`darkflat calibrate --lamp-spectra`): here they are given by level.
"""

from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Response, status
from pydantic import BaseModel, ConfigDict, Field

from calib.recording.tone import Tone
from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.dependencies import PartsDep
from service.api.jobs.starting import start_job
from service.api.model_text import ModelText, check_model
from service.api.openapi import problems
from service.store.actor import Actor
from service.store.store import Store

router = APIRouter(prefix="/v1/calibrations", tags=["calibrations"])

_SET = "coefficient-set.h5"


class ToneRequest(BaseModel):
    """A known synchronous tone to remove."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    cycles_per_pixel: float = Field(description="Cycles per pixel clock; at most 0.5, not 0.")
    pixels_per_line: float = Field(description="Pixel clocks per line, blanking included.")

    def check(self) -> None:
        """Raise InputError `tone-invalid` where no tone can be so."""
        Tone(self.cycles_per_pixel, self.pixels_per_line)


class CalibrationRequest(BaseModel):
    """Which recording, and how."""

    model_config = ConfigDict(
        extra="forbid",
        allow_inf_nan=False,
        json_schema_extra={
            "examples": [{"recording": "9b2b3a5c" * 8, "radiances": {"2": 20.1, "4": 40.2}}]
        },
    )

    recording: str = Field(description="Its digest.")
    radiances: dict[float, Annotated[float, Field(gt=0)]] | None = Field(
        default=None, description="Radiance by level; goes before what blocks state."
    )
    relative: bool = Field(default=False, description="Do without radiances.")
    order: int | None = Field(default=None, ge=2, le=20, description="Of the vignette.")
    darks_required: bool = True
    tone: ToneRequest | None = None
    model: ModelText | None = Field(
        default=None,
        description="A model file's text: its departures are taken out of the calibration.",
    )


@router.post("", status_code=status.HTTP_202_ACCEPTED, responses=problems(404, 429))
def start_calibration(
    *, wanted: CalibrationRequest, response: Response, known: PartsDep, operator: Operator
) -> JobAnswer:
    """Queue a calibration; follow it at the `Location`. Its set is added as a draft."""
    if wanted.tone is not None:
        wanted.tone.check()
    check_model(wanted.model)
    recording = known.store.recordings.get(wanted.recording)
    return start_job(
        "calibrate",
        wanted,
        known=known,
        response=response,
        prepare=lambda scratch: {
            "recording_path": recording.path,
            "out_path": str(scratch / _SET),
        },
        finish=lambda scratch, made: _keep(known.store, scratch / _SET, made, operator),
    )


def _keep(store: Store, made: Path, result: dict[str, Any], by: Actor) -> dict[str, Any]:
    """Add the set that the job made to the store."""
    from calib.radiometric.coefficients.coefficient_set import CoefficientSet  # noqa: PLC0415  (slow to import)

    store.sets.add(CoefficientSet.load(made), by=by, reason="calibrated")
    return result
