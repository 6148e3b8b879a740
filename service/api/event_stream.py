"""A run's journal as server-sent events (the HTML standard, section 9.2)."""

import asyncio
import json
from collections.abc import AsyncIterator

from starlette.concurrency import run_in_threadpool

from service.api.answers.run import EventAnswer
from service.runs.news import News
from service.store.run_records import FINAL, RunEvent
from service.store.runs import Runs

_ALIVE_S = 15.0
"""A comment so often keeps proxies from closing a silent stream."""


async def event_stream(runs: Runs, news: News, run_id: str, after: int) -> AsyncIterator[str]:
    """Yield the events after number `after`, then each new one, until the run's state is final."""
    loop, changed = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:
        loop.call_soon_threadsafe(changed.set)

    leave = news.follow(wake)
    try:
        while True:
            changed.clear()
            events = await run_in_threadpool(runs.events, run_id, after=after)
            for event in events:
                yield _sent(event)
                after = event.number
            if events:
                continue
            if (await run_in_threadpool(runs.get, run_id)).state in FINAL:
                return
            try:
                await asyncio.wait_for(changed.wait(), _ALIVE_S)
            except TimeoutError:
                yield ": still here\n\n"
    finally:
        leave()


def _sent(event: RunEvent) -> str:
    data = json.dumps(EventAnswer.of(event).model_dump(mode="json"), allow_nan=False)
    return f"id: {event.number}\nevent: {event.kind}\ndata: {data}\n\n"
