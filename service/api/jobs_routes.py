"""`/v1/jobs`: long work and what came of it."""

from fastapi import APIRouter
from fastapi.responses import FileResponse

from service.api.access import Operator
from service.api.answers.job import JobAnswer, JobPage
from service.api.dependencies import RunnerDep, StoreDep
from service.api.jobs.files import MEDIA_TYPES
from service.api.jobs.runner import JobRunner
from service.api.openapi import problems
from service.api.paging import Before, Limit
from service.store.records import JobRecord

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

_SCHEMAS: dict[str, dict[str, str]] = {
    "application/json": {},
    "application/x-hdf5": {"type": "string", "format": "binary"},
}
_SAFE = {
    "Cache-Control": "private, max-age=31536000, immutable",
    "Content-Security-Policy": "sandbox; default-src 'none'; img-src data:;"
    " style-src 'unsafe-inline'; font-src data:",
    "X-Content-Type-Options": "nosniff",
}
"""A report opened from here is a page of its own, without the rights of the service's page."""


@router.get("", responses=problems())
def list_jobs(
    store: StoreDep,
    runner: RunnerDep,
    limit: Limit = 100,
    before: Before = None,
) -> JobPage:
    """List jobs, newest first."""
    page = store.jobs.list(limit=limit, before=before)
    items = tuple(_answer(each, runner) for each in page.items)
    return JobPage(items=items, next_before=page.next_before)


@router.get("/{job_id}", responses=problems(404))
def get_job(job_id: str, store: StoreDep, runner: RunnerDep) -> JobAnswer:
    """Say how far a job is, or what came of it."""
    return _answer(store.jobs.get(job_id), runner)


@router.get(
    "/{job_id}/files/{name}",
    response_class=FileResponse,
    responses={
        **problems(404),
        200: {
            "description": "The file.",
            "content": {
                kind: {"schema": _SCHEMAS.get(kind, {"type": "string"})}
                for kind in MEDIA_TYPES.values()
            },
        },
    },
)
def get_job_file(job_id: str, name: str, store: StoreDep, runner: RunnerDep) -> FileResponse:
    """Download what a job left; it never changes. A page runs no scripts and asks for nothing."""
    file = runner.files.get(store.jobs.get(job_id).id, name)
    return FileResponse(
        file.path,
        media_type=file.media_type,
        filename=f"{job_id[:8]}-{file.name}",
        content_disposition_type="inline" if file.media_type == "text/html" else "attachment",
        headers=_SAFE,
    )


@router.post("/{job_id}/cancel", responses=problems(404))
def cancel_job(job_id: str, runner: RunnerDep, _operator: Operator) -> JobAnswer:
    """End a job at once, whether it waits or runs; one that is done stays as it is."""
    return _answer(runner.cancel(job_id), runner)


def _answer(record: JobRecord, runner: JobRunner) -> JobAnswer:
    return JobAnswer.of(record, runner.progress(record.id), runner.files.of(record.id))
