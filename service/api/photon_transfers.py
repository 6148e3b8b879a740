"""`/v1/photon-transfers`: from a recording to its system gain and its data sheet, as a job."""

from typing import Literal

from fastapi import APIRouter, Response, status
from pydantic import BaseModel, ConfigDict, Field

from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.dependencies import PartsDep
from service.api.jobs.starting import start_job
from service.api.openapi import problems

router = APIRouter(prefix="/v1/photon-transfers", tags=["photon transfer"])


class PhotonTransferRequest(BaseModel):
    """Which recording, and by which method."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"recording": "9b2b3a5c" * 8, "method": "ptc"}]},
    )

    recording: str = Field(description="Its digest.")
    method: Literal["ptc", "sanuc", "s3nuc"] = Field(
        default="ptc", description="The whole curve with EMVA 1288, or two exposures of one scene."
    )


@router.post("", status_code=status.HTTP_202_ACCEPTED, responses=problems(404, 429))
def start_photon_transfer(
    *, wanted: PhotonTransferRequest, response: Response, known: PartsDep, _operator: Operator
) -> JobAnswer:
    """Queue a photon transfer; its job leaves the data sheet, or maps of every pixel."""
    recording = known.store.recordings.get(wanted.recording)
    private = {"recording_path": recording.path}
    return start_job(
        "photon-transfer", wanted, known=known, response=response, prepare=lambda _: private
    )
