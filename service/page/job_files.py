"""`/page/jobs/…`: what a job left, for who has signed in; a browser sends no key with a link."""

from fastapi import APIRouter, Request
from fastapi.responses import Response
from nicegui import ui
from starlette.concurrency import run_in_threadpool

from service.api.jobs_routes import get_job_file
from service.page.page_headers import PLACE
from service.page.visitor import Visitor
from service.store.keys import Scope

router = APIRouter(prefix=PLACE, include_in_schema=False)


@router.get("/jobs/{job_id}/files/{name}")
async def show_file(job_id: str, name: str, request: Request) -> Response:
    """Show a page, or download anything else."""
    visitor = Visitor(request)
    await visitor.actor(Scope.READ)
    store, runner = visitor.parts.store, visitor.parts.runner
    return await run_in_threadpool(get_job_file, job_id, name, store=store, runner=runner)


def draw_files(visitor: Visitor, job_id: str, *, view: str = "") -> None:
    """Draw a link to each file that a job left, and before them one to the view of its figures."""
    files = visitor.parts.runner.files.of(job_id)
    if files or view:
        with ui.row().classes("df-actions"):
            if view:
                ui.link("Figures", f"/{view}?job={job_id}")
            for file in files:
                ui.link(file.name, f"/jobs/{job_id}/files/{file.name}", new_tab=True)
