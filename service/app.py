"""Where the parts are joined: settings, store, jobs, and the routes."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import PackageNotFoundError, version

from fastapi import Depends, FastAPI
from prometheus_client import CollectorRegistry
from starlette.concurrency import run_in_threadpool

from service.api import (
    apply,
    audit,
    bench,
    calibrations,
    coefficient_sets,
    diagnoses,
    health,
    jobs_routes,
    metrics,
    photon_transfers,
    recordings,
    runs,
    transfer_functions,
)
from service.api.access import needs
from service.api.body_limit import LimitedBodies
from service.api.dependencies import Parts
from service.api.event_stream import EventStreams
from service.api.hosts import OnlyKnownHosts, OnlyOwnPages
from service.api.jobs.files import JobFiles
from service.api.jobs.runner import JobRunner
from service.api.jobs.scratch import clear_scratch
from service.api.key_ring import KeyRing
from service.api.openapi import describe_api
from service.api.problems import add_problem_handlers
from service.api.recording_files import take_back
from service.api.security_headers import SecurityHeaders
from service.bench.settings import BenchSettings
from service.owner.owner import BenchOwner
from service.plan.model import Plan
from service.runs.keeper import RunKeeper
from service.settings import Settings
from service.store.keys import Scope
from service.store.store import Store
from service.watching.requests import CountRequests
from service.watching.state import watch

_ROUTES = (
    bench,
    runs,
    recordings,
    calibrations,
    photon_transfers,
    diagnoses,
    transfer_functions,
    jobs_routes,
    coefficient_sets,
    apply,
    audit,
    metrics,
)


def create_app(
    settings: Settings | None = None,
    *,
    bench_settings: BenchSettings | None = None,
    owner: BenchOwner | None = None,
    page: bool = False,
) -> FastAPI:
    """Return the service; nothing is opened before it is started.

    Args:
        settings: Those of the environment where None.
        bench_settings: The bench that it owns; None: it has none, and keeps and calculates only.
        owner: Of the bench, where that is being opened already; it ends with the app.
        page: Whether browsers are served too; one app of a process can.
    """
    known = settings or Settings.load()

    def bench_owner() -> BenchOwner | None:
        return owner or (None if bench_settings is None else BenchOwner(bench_settings))

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        parts = await run_in_threadpool(_open, known, bench_owner())
        app.state.parts = parts
        try:
            yield
        finally:
            app.state.parts = None
            await run_in_threadpool(_close, parts)

    app = FastAPI(
        title="darkflat",
        version=_version(),
        summary="From a camera, a light source and a stack of frames to radiance one can trust.",
        lifespan=lifespan,
    )
    app.add_middleware(LimitedBodies, limit_bytes=known.max_json_bytes)
    app.add_middleware(OnlyOwnPages)
    app.add_middleware(OnlyKnownHosts, hosts=known.host_names)
    app.add_middleware(SecurityHeaders)
    app.state.registry = CollectorRegistry()
    app.add_middleware(CountRequests, registry=app.state.registry)
    watch(app.state.registry, lambda: _watched(app))
    add_problem_handlers(app)
    app.include_router(health.router)
    for module in _ROUTES:
        app.include_router(module.router, dependencies=[Depends(needs(Scope.READ))])
    describe_api(app, Plan)
    if page:
        from service.page.mount import mount_page  # noqa: PLC0415  (slow to import, global state)

        mount_page(app)
    return app


def _watched(app: FastAPI) -> tuple[Store, RunKeeper | None] | None:
    opened: Parts | None = getattr(app.state, "parts", None)
    return None if opened is None else (opened.store, opened.keeper)


def _open(settings: Settings, owner: BenchOwner | None) -> Parts:
    store = Store.open(settings)
    settings.work_folder.mkdir(parents=True, exist_ok=True)
    take_back(settings, store)
    clear_scratch(settings)
    runner = JobRunner(store, JobFiles(settings.jobs_folder), max_waiting=settings.max_queued_jobs)
    runner.start()
    keeper = streams = None
    if owner is not None:
        keeper = RunKeeper(store, owner, settings.runs_folder)
        keeper.start()
        streams = EventStreams(store.runs, keeper.news)
    return Parts(settings, store, runner, keeper, streams, KeyRing(store.keys))


def _close(parts: Parts) -> None:
    if parts.keeper is not None:
        parts.keeper.close()
    parts.runner.close()
    parts.store.close()


def _version() -> str:
    try:
        return version("darkflat")
    except PackageNotFoundError:
        return "0"
