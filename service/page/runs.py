"""Runs: a plan is checked and started here; each run is followed, held, and ended."""

from nicegui import ui

from service.api.answers.run import PlanAnswer
from service.page.example_plan import EXAMPLE
from service.page.frame import keep_fresh, view
from service.page.run_detail import RunDetail
from service.page.run_stand import duration, name_of, stand
from service.page.tables import Show, fill, table, text
from service.page.visitor import Visitor, say
from service.plan.model import Plan
from service.store.actor import Actor
from service.store.keys import Scope
from service.store.run_records import RunRecord

_REFRESH_S = 0.7
_SHOWN = 100


@view("/runs")
async def show(visitor: Visitor) -> None:
    """The plan on the left, the runs and the chosen one on the right."""
    detail = RunDetail(visitor)
    with ui.element("div").classes("df-columns"):
        with ui.element("section").classes("df-card df-side").props('aria-label="A new run"'):
            _editor(visitor, detail.show)
        with ui.element("section").classes("df-card").props('aria-label="Runs"'):
            listed = table(
                {"name": "plan", "stands": "state", "by": "by", "at": "submitted"},
                label="Runs, newest first",
                show=detail.show,
                rows=5,
            )
            detail.draw_below()

    async def refresh() -> None:
        runs = await visitor.read(lambda: visitor.parts.store.runs.list(limit=_SHOWN).items)
        fill(listed, [_row(run) for run in runs or ()])
        await detail.refresh()

    if visitor.asked("run"):
        await detail.show(visitor.asked("run"))
    keep_fresh(visitor, refresh, _REFRESH_S)


def _row(run: RunRecord) -> dict[str, object]:
    return {
        "key": run.id,
        "name": name_of(run),
        "stands": stand(run).text,
        "by": run.submitted_by,
        "at": text(run.submitted_at),
    }


def _editor(visitor: Visitor, show_run: Show) -> None:
    """Draw where a plan is written; `show_run` is told the id of what was started."""
    written = ui.textarea("Plan (TOML or JSON)", value=EXAMPLE).props(
        'outlined spellcheck="false" input-class="df-plan"'
    )

    async def validate() -> None:
        answer.clear()
        found = await visitor.read(lambda: PlanAnswer.of(_parsed(written.value)))
        if found is not None:
            with answer:
                _draw_plan(found)

    async def start() -> None:
        def submit(by: Actor) -> RunRecord:
            plan = _parsed(written.value)
            return visitor.commands().submit(plan, by, idempotency_key=None)[0]

        run = await visitor.act(Scope.OPERATE, submit)
        if run is not None:
            say(f"Run {name_of(run)} is queued")
            await show_run(run.id)

    with ui.row():
        ui.button("Validate", on_click=validate).props("outline no-caps")
        ui.button("Start", on_click=start).props('unelevated no-caps color="secondary"')
    answer = ui.element("div").props('role="status"')


def _parsed(written: str) -> Plan:
    return Plan.loads(written, json_text=written.lstrip().startswith("{"))


def _draw_plan(found: PlanAnswer) -> None:
    size = "" if found.bytes is None else f", {found.bytes / 1e6:.1f} MB"
    ui.label(f"{len(found.steps)} blocks, about {duration(found.total_s)}{size}")
    steps = table(
        {"name": "block", "kind": "kind", "exposure": "exposure / µs", "level": "level"},
        label="Blocks of the plan",
        rows=5,
    )
    fill(
        steps,
        [
            {
                "key": step.block,
                "name": step.block,
                "kind": step.kind,
                "exposure": step.exposure_us,
                "level": step.level,
            }
            for step in found.steps
        ],
    )
