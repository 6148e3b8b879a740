"""`/v1/photon-transfers`: from a recording to its system gain and its data sheet, as a job."""

from typing import Literal

from fastapi import APIRouter, Response, status
from pydantic import BaseModel, ConfigDict, Field

from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.dependencies import RunnerDep, SettingsDep, StoreDep
from service.api.jobs.scratch import FILES, new_scratch
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
    *,
    wanted: PhotonTransferRequest,
    response: Response,
    store: StoreDep,
    settings: SettingsDep,
    runner: RunnerDep,
    _operator: Operator,
) -> JobAnswer:
    """Queue a photon transfer; its job leaves the data sheet, or maps of every pixel."""
    recording = store.recordings.get(wanted.recording)
    scratch = new_scratch(settings)
    record = runner.submit(
        "photon-transfer",
        wanted.model_dump(),
        {"recording_path": recording.path, "files": str(scratch / FILES)},
        lambda result: result,
        scratch=scratch,
    )
    response.headers["Location"] = f"/v1/jobs/{record.id}"
    return JobAnswer.of(record)
