"""`/healthz` and `/readyz`: for whoever watches the service."""

from fastapi import APIRouter

from calib.errors import DarkflatError
from drivers.errors import DeviceError
from service.api.answers.health import Alive, Ready
from service.api.dependencies import PartsDep, RunnerDep, StoreDep
from service.api.openapi import problems
from service.runs.keeper import RunKeeper

router = APIRouter(tags=["health"])


@router.get("/healthz", responses=problems("jobs-stopped", keyless=True))
def healthz(runner: RunnerDep) -> Alive:
    """Say that the process is alive and does jobs; a problem where only a restart helps."""
    runner.check_alive()
    return Alive()


@router.get("/readyz", responses=problems("jobs-stopped", "bench-not-ready", keyless=True))
def readyz(store: StoreDep, runner: RunnerDep, known: PartsDep) -> Ready:
    """Say that jobs are done, the store can be written, and the bench used; else a problem."""
    runner.check_alive()
    store.check_writable()
    if known.keeper is None:
        return Ready(bench="none")
    _check_bench(known.keeper)
    return Ready(bench="reachable")


def _check_bench(keeper: RunKeeper) -> None:
    """Raise DeviceError `bench-not-ready`, whatever the trouble is."""
    try:
        keeper.owner.check_reachable()
    except DarkflatError as error:
        raise DeviceError(
            str(error), device=keeper.owner.bench_id, code="bench-not-ready"
        ) from error
