"""Long work: how far each job is, and its end by hand."""

from typing import Final

from nicegui import ui

from service.api.jobs_routes import cancel_job
from service.page.job_files import draw_files
from service.page.tables import text
from service.page.visitor import Visitor
from service.store.jobs import FINAL
from service.store.keys import Scope
from service.store.records import JobRecord

_SHOWN = 6
_VIEWS: Final = {
    "diagnose": "diagnosis",
    "photon-transfer": "sensor",
    "transfer-function": "sensor",
}
"""Where the figures of a kind of job are."""


class JobList:
    """The newest jobs of some kinds; drawn where it is made."""

    def __init__(self, visitor: Visitor, kinds: frozenset[str] | None = None) -> None:
        self._visitor = visitor
        self._kinds = kinds
        self._stood: object = None
        self._all = ui.element("div").props('role="region" aria-label="Jobs"')

    async def refresh(self) -> None:
        """Show what is new."""
        parts = self._visitor.parts
        found = await self._visitor.read(lambda: parts.store.jobs.list(limit=50).items)
        jobs = [j for j in found or () if self._kinds is None or j.kind in self._kinds][:_SHOWN]
        stands = [(job, parts.runner.progress(job.id)) for job in jobs]
        if stands == self._stood:
            return
        self._stood = stands
        self._all.clear()
        with self._all:
            if not stands:
                ui.label("None yet.").classes("df-note")
            for job, share in stands:
                self._draw(job, share)

    def _draw(self, job: JobRecord, share: float | None) -> None:
        with ui.row().classes("df-job"):
            done = "" if share is None else f", {100 * share:.0f} %"
            ui.label(f"{job.kind}: {job.state}{done}")
            ui.label(text(job.submitted_at)).classes("df-note")
            if job.state not in FINAL:
                ui.button("Cancel", on_click=lambda: self._cancel(job.id)).props(
                    f'outline dense no-caps aria-label="Cancel {job.kind}"'
                )
        view = _VIEWS.get(job.kind, "") if job.state == "succeeded" else ""
        draw_files(self._visitor, job.id, view=view)
        if job.error_message is not None:
            ui.label(job.error_message).classes("df-trouble")

    async def _cancel(self, job_id: str) -> None:
        runner = self._visitor.parts.runner
        await self._visitor.act(
            Scope.OPERATE, lambda by: cancel_job(job_id, runner=runner, _operator=by)
        )
        await self.refresh()
