"""`/v1/jobs`: long work and what came of it."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.api.access import Operator
from service.api.answers.job import JobAnswer, JobPage
from service.api.dependencies import RunnerDep, StoreDep
from service.api.openapi import problems

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


@router.get("", responses=problems())
def list_jobs(
    store: StoreDep,
    runner: RunnerDep,
    limit: Annotated[int, Query(ge=1, le=500)] = 100,
    before: Annotated[int | None, Query(ge=0, le=2**63 - 1)] = None,
) -> JobPage:
    """List jobs, newest first."""
    page = store.jobs.list(limit=limit, before=before)
    items = tuple(JobAnswer.of(each, runner.progress(each.id)) for each in page.items)
    return JobPage(items=items, next_before=page.next_before)


@router.get("/{job_id}", responses=problems(404))
def get_job(job_id: str, store: StoreDep, runner: RunnerDep) -> JobAnswer:
    """Say how far a job is, or what came of it."""
    return JobAnswer.of(store.jobs.get(job_id), runner.progress(job_id))


@router.post("/{job_id}/cancel", responses=problems(404))
def cancel_job(job_id: str, runner: RunnerDep, _operator: Operator) -> JobAnswer:
    """End a job at once, whether it waits or runs; one that is done stays as it is."""
    return JobAnswer.of(runner.cancel(job_id))
