"""`/v1/diagnoses`: what recordings show that the plain model lacks, as a job."""

from fastapi import APIRouter, Response, status
from pydantic import BaseModel, ConfigDict, Field

from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.dependencies import PartsDep
from service.api.jobs.starting import start_job
from service.api.model_text import ModelText, check_model
from service.api.openapi import problems

router = APIRouter(prefix="/v1/diagnoses", tags=["diagnosis"])


class DiagnosisRequest(BaseModel):
    """Which recordings, and what the sensor should be."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"recording": "9b2b3a5c" * 8}]}
    )

    recording: str = Field(description="Its digest.")
    second_recording: str | None = Field(
        default=None, description="Another one of the same bench, diagnosed together with it."
    )
    model: ModelText | None = Field(
        default=None,
        description="A model file's text; without it, what the plain model lacks is looked for.",
    )


@router.post("", status_code=status.HTTP_202_ACCEPTED, responses=problems(404, 429))
def start_diagnosis(
    *, wanted: DiagnosisRequest, response: Response, known: PartsDep, _operator: Operator
) -> JobAnswer:
    """Queue a diagnosis; its job leaves a page to read, and the model with what was found."""
    check_model(wanted.model)
    named = [each for each in (wanted.recording, wanted.second_recording) if each is not None]
    recordings = [known.store.recordings.get(each) for each in named]
    private = {
        "recording_paths": [each.path for each in recordings],
        "names": [each.name for each in recordings],
    }
    return start_job("diagnose", wanted, known=known, response=response, prepare=lambda _: private)
