"""`/v1/bench` and `/v1/safe-off`: how the bench is, and every lamp off."""

from fastapi import APIRouter

from service.api.access import Operator, Reader
from service.api.answers.bench import BenchAnswer, DeviceAnswer, KeptDarkAnswer, LampsOff
from service.api.answers.job import JobError
from service.api.dependencies import CommandsDep, KeeperDep, StoreDep
from service.api.openapi import BENCH, problems
from service.runs.keeper import RunKeeper
from service.store.store import Store

router = APIRouter(prefix="/v1", tags=["bench"])


@router.get("/bench", responses=problems("no-bench"))
def get_bench(store: StoreDep, keeper: KeeperDep, _reader: Reader) -> BenchAnswer:
    """Say what the bench does and who has it; no device is asked for that."""
    return _told(store, keeper)


@router.post("/bench/release", responses=problems(*BENCH))
def release_bench(
    operator: Operator, commands: CommandsDep, store: StoreDep, keeper: KeeperDep
) -> BenchAnswer:
    """Let queued runs begin after safe-off, whoever pressed it; say how the bench is then."""
    commands.release(operator)
    return _told(store, keeper)


def _told(store: Store, keeper: RunKeeper) -> BenchAnswer:
    owner, run = keeper.owner, store.runs.under_way()
    trouble, kept = owner.trouble, keeper.darkness.kept
    return BenchAnswer(
        id=owner.bench_id,
        state=owner.state,
        trouble=None if trouble is None else JobError(code=trouble.code, message=trouble.message),
        run=None if run is None else run.id,
        held_by=None if run is None else run.submitted_by,
        kept_dark=None if kept is None else KeptDarkAnswer(by=kept.by, since=kept.since),
        devices=() if owner.look is None else tuple(map(DeviceAnswer.of, owner.look.devices)),
    )


@router.post("/bench/look", responses=problems(423, 502, *BENCH))
def look_at_bench(operator: Operator, commands: CommandsDep) -> tuple[DeviceAnswer, ...]:
    """Ask every device how it is, while nobody else has the bench."""
    return tuple(map(DeviceAnswer.of, commands.look(operator).devices))


@router.post("/safe-off", responses=problems(502, *BENCH))
def safe_off(operator: Operator, commands: CommandsDep) -> LampsOff:
    """Abort what runs, switch every lamp off and read it back, whoever has the bench.

    Queued runs wait, over restarts of the service too, until somebody releases the bench, submits
    a run or resumes one.
    Software is no interlock: where light can harm, a switch must be within reach.
    """
    return LampsOff.of(commands.safe_off(operator))
