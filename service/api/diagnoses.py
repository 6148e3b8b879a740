"""`/v1/diagnoses`: what recordings show that the plain model lacks, as a job."""

from fastapi import APIRouter, Response, status
from pydantic import BaseModel, ConfigDict, Field

from service.api.access import Operator
from service.api.answers.job import JobAnswer
from service.api.dependencies import RunnerDep, SettingsDep, StoreDep
from service.api.jobs.scratch import FILES, new_scratch
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
    model: str | None = Field(
        default=None,
        max_length=1 << 24,
        description="A model file's text; without it, what the plain model lacks is looked for.",
    )


@router.post("", status_code=status.HTTP_202_ACCEPTED, responses=problems(404, 429))
def start_diagnosis(
    *,
    wanted: DiagnosisRequest,
    response: Response,
    store: StoreDep,
    settings: SettingsDep,
    runner: RunnerDep,
    _operator: Operator,
) -> JobAnswer:
    """Queue a diagnosis; its job leaves a page to read, and the model with what was found."""
    if wanted.model is not None:
        from calib.forward.model import Model  # noqa: PLC0415  (slow to import)

        Model.loads(wanted.model)
    named = [each for each in (wanted.recording, wanted.second_recording) if each is not None]
    recordings = [store.recordings.get(each) for each in named]
    scratch = new_scratch(settings)
    record = runner.submit(
        "diagnose",
        wanted.model_dump(),
        {
            "recording_paths": [each.path for each in recordings],
            "names": [each.name for each in recordings],
            "files": str(scratch / FILES),
        },
        lambda result: result,
        scratch=scratch,
    )
    response.headers["Location"] = f"/v1/jobs/{record.id}"
    return JobAnswer.of(record)
