"""Diagnosis: what the jobs found to be missing from the model, with what it explains."""

from collections.abc import Mapping
from typing import Any

from nicegui import ui

from service.page.figures.deviance import before_and_after
from service.page.frame import view
from service.page.job_files import draw_files
from service.page.listed_jobs import keep_listed
from service.page.tables import facts, table, text
from service.page.visitor import Visitor
from service.store.records import JobRecord

KIND = "diagnose"


@view("/diagnosis")
async def show(visitor: Visitor) -> None:
    """The diagnoses on the left, the report of the chosen one on the right."""
    report = _Report(visitor)
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card df-side-wide").props('aria-label="Diagnoses"'):
            listed = table(
                {"name": "recording", "state": "state", "verdict": "verdict", "at": "asked"},
                label="Diagnoses, newest first",
                show=report.show,
            )
            ui.label("A diagnosis is started from a recording.").classes("df-note")
        with ui.element("section").classes("df-card").props('aria-label="Report"'):
            report.draw()
    await keep_listed(visitor, listed, (KIND,), _row, report.show)


class _Report:
    def __init__(self, visitor: Visitor) -> None:
        self._visitor = visitor

    def draw(self) -> None:
        self._all = ui.element("div").props('role="region" aria-label="The chosen diagnosis"')
        with self._all:
            ui.label("Show a diagnosis to see its report.").classes("df-note")

    async def show(self, job_id: str) -> None:
        job = await self._visitor.read(lambda: self._visitor.parts.store.jobs.get(job_id))
        if job is not None:
            self._all.clear()
            with self._all:
                _draw(job)
                draw_files(self._visitor, job.id)


def _row(job: JobRecord) -> dict[str, object]:
    return {
        "key": job.id,
        "name": str(job.request.get("recording", ""))[:8],
        "state": job.state,
        "verdict": text(_answer(job).get("verdict")),
        "at": text(job.submitted_at),
    }


def _answer(job: JobRecord) -> Mapping[str, Any]:
    """Return what `diagnose --json` answers: it is the job's result, or in it."""
    result = job.result or {}
    inner = result.get("diagnosis", result)
    return inner if isinstance(inner, Mapping) else {}


def _draw(job: JobRecord) -> None:
    answer = _answer(job)
    ui.label(f"Verdict: {text(answer.get('verdict') or job.state)}").classes("df-subtitle")
    if job.error_message is not None:
        ui.label(job.error_message).classes("df-trouble")
    findings = answer.get("findings") or []
    if findings:
        ui.plotly(before_and_after(findings)).classes("df-figure-low").props(
            'aria-label="Deviance before and after"'
        )
    for finding in findings:
        _draw_finding(finding)
    left = answer.get("unexplained")
    if left:
        ui.label("Unexplained").classes("df-device")
        facts({"σ": left.get("significance_sigma"), "where": (left.get("where") or {}).get("text")})
    further = answer.get("next_measurement")
    if further:
        ui.label("Next measurement").classes("df-device")
        ui.label(text(further.get("why")))


def _draw_finding(finding: Mapping[str, Any]) -> None:
    ui.label(str(finding.get("effect"))).classes("df-device")
    rivals = [
        f"{each['effect']} {100 * each['probability']:.0f} %"
        for each in finding.get("candidates", ())[1:]
    ]
    facts(
        {
            "probability": finding.get("probability"),
            "σ": finding.get("significance_sigma"),
            "explains": finding.get("fraction_explained"),
            "where": (finding.get("where") or {}).get("text"),
            "physics": finding.get("physics"),
            "may also be": ", ".join(rivals),
            **_parameters(finding),
        }
    )


def _parameters(finding: Mapping[str, Any]) -> dict[str, object]:
    return {
        name: f"{text(each.get('value'))} ± {text(each.get('std'))} {each.get('unit', '')}"
        for name, each in (finding.get("parameters") or {}).items()
    }
