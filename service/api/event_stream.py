"""A run's journal as server-sent events (the HTML standard, section 9.2)."""

import asyncio
import json
from collections.abc import AsyncIterator

from service.api.answers.run import EventAnswer
from service.api.shared_reading import SharedReading
from service.runs.news import News
from service.store.run_records import FINAL, RunEvent
from service.store.runs import Runs

_ALIVE_S = 15.0
"""A comment so often keeps proxies from closing a silent stream."""
_MOST = 500
"""Events that are read at once."""


class EventStreams:
    """The streams of all who follow runs: what they wait for together is read and written once."""

    def __init__(self, runs: Runs, news: News) -> None:
        self._runs = runs
        self._news = news
        self._reading: SharedReading[tuple[list[str], bool]] = SharedReading()

    async def follow(self, run_id: str, after: int) -> AsyncIterator[str]:
        """Yield the events after number `after`, then each new one, until the state is final."""
        loop, changed = asyncio.get_running_loop(), asyncio.Event()

        def wake() -> None:
            loop.call_soon_threadsafe(changed.set)

        leave = self._news.follow(wake)
        try:
            while True:
                changed.clear()
                texts, is_final = await self._after(run_id, after)
                if texts:
                    yield "".join(texts)
                    after += len(texts)
                elif is_final:
                    return
                if is_final or len(texts) == _MOST:  # there may be more
                    continue
                try:
                    async with asyncio.timeout(_ALIVE_S):
                        await changed.wait()
                except TimeoutError:
                    yield ": still here\n\n"
        finally:
            leave()

    async def _after(self, run_id: str, after: int) -> tuple[list[str], bool]:
        """Return the next events as they are sent, and whether the state was final before that.

        Whoever asks for the same after the same news is given the same: a reading that began before
        the news may not have it.
        """
        asked = (run_id, after, self._news.told)
        return await self._reading.get(asked, lambda: self._read(run_id, after))

    def _read(self, run_id: str, after: int) -> tuple[list[str], bool]:
        # The state first: the event of a final one was written together with it.
        is_final = self._runs.get(run_id).state in FINAL
        events = self._runs.events(run_id, after=after, limit=_MOST)
        return list(map(_sent, events)), is_final


def _sent(event: RunEvent) -> str:
    data = json.dumps(EventAnswer.of(event).model_dump(mode="json"), allow_nan=False)
    return f"id: {event.number}\nevent: {event.kind}\ndata: {data}\n\n"
