"""Many follow one run: what they read together is read once, and nobody misses anything."""

import asyncio
import json
import threading
from collections.abc import AsyncIterator
from datetime import UTC, datetime
from typing import Any, cast

import numpy as np
import pytest

from service.api.event_stream import EventStreams
from service.api.shared_reading import SharedReading
from service.owner.messages import Seen
from service.runs.news import News
from service.store.actor import Actor
from service.store.run_records import RunEvent, RunState
from service.store.runs import Runs
from service.store.store import Store

WITHIN_S = 60.0


def _numbers(text: str) -> list[int]:
    return [int(line[4:]) for line in text.splitlines() if line.startswith("id: ")]


async def _all(stream: AsyncIterator[str]) -> list[int]:
    return [number async for text in stream for number in _numbers(text)]


def test_all_who_follow_are_told_everything_once_and_in_order(store: Store) -> None:
    run, _ = store.runs.submit({}, "digest", blocks_total=1, by=Actor("pc"))
    news = News()
    streams = EventStreams(store.runs, news)

    def measure() -> None:
        states: tuple[RunState, ...] = ("running", "pausing", "paused", "running", "succeeded")
        for state in states:
            store.runs.move(run.id, state)
            news.tell()
            for _ in range(3):
                store.runs.progress(run.id, "progress", {"blocks_done": 1})
                news.tell()

    async def follow() -> list[list[int]]:
        streams_of_all = [streams.follow(run.id, after % 3) for after in range(30)]
        told, _ = await asyncio.gather(
            asyncio.gather(*map(_all, streams_of_all)), asyncio.to_thread(measure)
        )
        return cast("list[list[int]]", told)

    told = asyncio.run(asyncio.wait_for(follow(), WITHIN_S))
    newest = max(event.number for event in store.runs.events(run.id))
    for after, numbers in enumerate(told):
        # A stream may end with the event of the final state: what comes after it is nobody's.
        assert numbers == list(range(after % 3 + 1, numbers[-1] + 1))
        assert newest - 3 <= numbers[-1] <= newest


class _Gated:
    """A journal whose first reading is done, and then not returned until it may be."""

    def __init__(self) -> None:
        self.gate = threading.Event()
        self.first_has_read = threading.Event()
        self.said: list[RunEvent] = []

    def say(self, state: str) -> None:
        at = datetime(2026, 1, 1, tzinfo=UTC)
        number = len(self.said) + 1
        self.said.append(RunEvent("run", number, at, "state", {"state": state}))

    def get(self, run_id: str) -> Any:
        del run_id
        return type("Run", (), {"state": self.said[-1].content["state"] if self.said else "queued"})

    def events(self, run_id: str, *, after: int, limit: int) -> tuple[RunEvent, ...]:
        del run_id
        found = tuple(self.said[after : after + limit])
        if not self.first_has_read.is_set():
            self.first_has_read.set()
            assert self.gate.wait(WITHIN_S)
        return found


def test_a_reading_from_before_the_news_is_not_given_to_who_asks_after_them() -> None:
    journal, news = _Gated(), News()
    streams = EventStreams(cast("Runs", journal), news)

    async def follow() -> tuple[list[int], list[int]]:
        early = asyncio.create_task(_all(streams.follow("run", 0)))
        await asyncio.to_thread(journal.first_has_read.wait, WITHIN_S)
        journal.say("succeeded")
        news.tell()
        late = await _all(streams.follow("run", 0))  # while the first reading still goes on
        journal.gate.set()
        return await early, late

    assert asyncio.run(asyncio.wait_for(follow(), WITHIN_S)) == ([1], [1])


class _Ending(_Gated):
    """A journal whose run ends just after it was first read."""

    def __init__(self, news: News) -> None:
        super().__init__()
        self.gate.set()
        self._news = news

    def events(self, run_id: str, *, after: int, limit: int) -> tuple[RunEvent, ...]:
        found = super().events(run_id, after=after, limit=limit)
        if not self.said:
            self.say("succeeded")
            self._news.tell()
        return found


def test_the_last_event_is_told_also_where_it_comes_while_the_journal_is_read() -> None:
    news = News()
    streams = EventStreams(cast("Runs", _Ending(news)), news)
    told = asyncio.wait_for(_all(streams.follow("run", 0)), WITHIN_S)
    assert asyncio.run(told) == [1]


def test_a_long_journal_is_told_to_its_end_though_nothing_new_comes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("service.api.event_stream._ALIVE_S", 10 * WITHIN_S)
    journal, news = _Gated(), News()
    journal.gate.set()
    for _ in range(1200):
        journal.say("running")

    async def follow() -> list[int]:
        told: list[int] = []
        async for text in EventStreams(cast("Runs", journal), news).follow("run", 0):
            told += _numbers(text)
            if len(told) == 1200:
                break
        return told

    assert asyncio.run(asyncio.wait_for(follow(), WITHIN_S)) == list(range(1, 1201))


def test_frames_wake_those_who_watch_and_news_those_who_follow() -> None:
    news, woken = News(), list[str]()
    leave = news.follow(lambda: woken.append("news"))
    leave_frames = news.watch(lambda: woken.append("frame"))
    news.tell()
    news.show(Seen("run", "000", np.zeros(4)))
    assert (woken, news.told) == (["news", "frame"], 1)
    leave()
    leave_frames()
    news.tell()
    news.show(Seen("run", "000", np.zeros(4)))
    assert woken == ["news", "frame"]


def test_events_are_json() -> None:
    journal, news = _Gated(), News()
    journal.first_has_read.set()
    journal.say("failed")
    streams = EventStreams(cast("Runs", journal), news)

    async def first() -> str:
        return await anext(streams.follow("run", 0))

    lines = asyncio.run(first()).split("\n")
    assert lines[:2] == ["id: 1", "event: state"]
    assert json.loads(lines[2].removeprefix("data: "))["content"] == {"state": "failed"}
    assert lines[3:] == ["", ""]


def test_what_many_ask_for_at_once_is_read_once_also_where_one_leaves() -> None:
    reading: SharedReading[int] = SharedReading()
    gate, calls = threading.Event(), []

    def read() -> int:
        calls.append(1)
        assert gate.wait(WITHIN_S)
        return len(calls)

    async def ask() -> list[int]:
        asking = [asyncio.create_task(reading.get("same", read)) for _ in range(50)]
        other = asyncio.create_task(reading.get("other", lambda: 7))
        assert await other == 7
        asking.pop(0).cancel()
        gate.set()
        assert await asyncio.gather(*asking) == [1] * 49
        return [await reading.get("same", read)]

    assert asyncio.run(asyncio.wait_for(ask(), WITHIN_S)) == [2]


def test_all_who_asked_are_told_what_went_wrong() -> None:
    reading: SharedReading[int] = SharedReading()

    async def ask() -> None:
        def fail() -> int:
            raise LookupError

        came = await asyncio.gather(
            *(reading.get("same", fail) for _ in range(3)), return_exceptions=True
        )
        assert [type(each) for each in came] == [LookupError] * 3
        with pytest.raises(LookupError):
            await reading.get("same", fail)

    asyncio.run(asyncio.wait_for(ask(), WITHIN_S))
