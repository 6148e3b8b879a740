"""`/v1/runs`: plans that the bench measures, one after the other."""

from typing import Annotated, Any

from fastapi import APIRouter, Body, Header, Query, Response, status
from fastapi.responses import JSONResponse, StreamingResponse

from service.api.access import Operator, Reader
from service.api.answers.run import EventAnswer, PlanAnswer, RunAnswer, RunPage
from service.api.dependencies import CommandsDep, StoreDep, StreamsDep
from service.api.openapi import BENCH, json_body, problems
from service.api.paging import Before, Limit
from service.plan.model import Plan
from service.store.run_records import RunState

router = APIRouter(prefix="/v1/runs", tags=["runs"])

IdempotencyKey = Annotated[str | None, Header(max_length=200)]
LastEventId = Annotated[int | None, Header(ge=0, le=2**63 - 1)]
_EXAMPLE = {
    "sweep": {"type": "exposure", "exposures_us": [200, 400, 800], "level": 2},
    "camera": {"line_period_us": 1400},
    "lines": 512,
}


@router.post(
    "",
    status_code=status.HTTP_202_ACCEPTED,
    response_model=RunAnswer,
    openapi_extra=json_body(Plan, _EXAMPLE),
    responses={
        **problems("idempotency-mismatch", *BENCH),
        200: {"model": PlanAnswer, "description": "`validate=true`: what the plan would do."},
    },
)
def start_run(
    *,
    plan: Annotated[dict[str, Any], Body()],
    response: Response,
    operator: Operator,
    commands: CommandsDep,
    validate: bool = False,
    idempotency_key: IdempotencyKey = None,
) -> RunAnswer | Response:
    """Queue a plan on the bench; follow it at the `Location`. One key and plan give one run."""
    checked = Plan.parse(plan)
    if validate:
        return JSONResponse(PlanAnswer.of(checked).model_dump(mode="json"))
    run, _ = commands.submit(checked, operator, idempotency_key=idempotency_key)
    response.headers["Location"] = f"/v1/runs/{run.id}"
    return RunAnswer.of(run)


@router.get("", responses=problems())
def list_runs(
    store: StoreDep,
    _reader: Reader,
    state: RunState | None = None,
    limit: Limit = 100,
    before: Before = None,
) -> RunPage:
    """List runs, newest first."""
    page = store.runs.list(state=state, limit=limit, before=before)
    return RunPage(items=tuple(map(RunAnswer.of, page.items)), next_before=page.next_before)


@router.get("/{run_id}", responses=problems(404))
def get_run(run_id: str, store: StoreDep, _reader: Reader) -> RunAnswer:
    """Say how far a run is, or what came of it."""
    return RunAnswer.of(store.runs.get(run_id))


@router.get(
    "/{run_id}/events",
    response_class=StreamingResponse,
    responses={
        **problems(404, *BENCH),
        200: {"content": {"text/event-stream": {}}, "description": "Its events, as they come."},
    },
)
def follow_run(
    run_id: str,
    store: StoreDep,
    streams: StreamsDep,
    _reader: Reader,
    last_event_id: LastEventId = None,
) -> StreamingResponse:
    """Stream what a run says until its state is final; `Last-Event-ID` goes on after that one."""
    store.runs.get(run_id)
    stream = streams.follow(run_id, last_event_id or 0)
    return StreamingResponse(
        stream, media_type="text/event-stream", headers={"Cache-Control": "no-store"}
    )


@router.get("/{run_id}/journal", responses=problems(404))
def read_journal(
    run_id: str,
    store: StoreDep,
    _reader: Reader,
    after: Annotated[int, Query(ge=0, le=2**63 - 1)] = 0,
    limit: Limit = 500,
) -> list[EventAnswer]:
    """Read what a run said after an event: the same as the stream, for those who poll."""
    return [EventAnswer.of(event) for event in store.runs.events(run_id, after=after, limit=limit)]


@router.post("/{run_id}/pause", responses=problems(404, "illegal-transition", 423, *BENCH))
def pause_run(run_id: str, operator: Operator, commands: CommandsDep) -> RunAnswer:
    """Hold a run; the step that is interrupted is done again, the lamps are as the plan says."""
    return RunAnswer.of(commands.pause(run_id, operator))


@router.post("/{run_id}/resume", responses=problems(404, "illegal-transition", 423, *BENCH))
def resume_run(run_id: str, operator: Operator, commands: CommandsDep) -> RunAnswer:
    """Let a paused run go on, or queue an interrupted, failed or cancelled one again."""
    return RunAnswer.of(commands.resume(run_id, operator))


@router.post("/{run_id}/abort", responses=problems(404, "illegal-transition", 423, *BENCH))
def abort_run(run_id: str, operator: Operator, commands: CommandsDep) -> RunAnswer:
    """End a run; its state is final once the lamps are off and the bench is free."""
    return RunAnswer.of(commands.abort(run_id, operator))
