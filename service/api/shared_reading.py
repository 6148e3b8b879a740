"""Reading once for all who want the same at the same time."""

import asyncio
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

from starlette.concurrency import run_in_threadpool

Found = TypeVar("Found")


class SharedReading(Generic[Found]):
    """Does what is asked for in a thread, once for all who ask before it is done."""

    def __init__(self) -> None:
        self._under_way: dict[Hashable, asyncio.Task[Found]] = {}

    async def get(self, asked: Hashable, read: Callable[[], Found]) -> Found:
        """Return what `read` gives, or gives whoever has asked for the same already."""
        task = self._under_way.get(asked)
        if task is None:
            task = asyncio.create_task(run_in_threadpool(read))
            self._under_way[asked] = task
            task.add_done_callback(lambda done: self._forget(asked, done))
        return await asyncio.shield(task)  # one who leaves does not end it for the others

    def _forget(self, asked: Hashable, done: asyncio.Task[Found]) -> None:
        del self._under_way[asked]
        if not done.cancelled():
            done.exception()  # whoever waited has it; where all have left, nobody misses it
