"""The keys as requests see them: read from the store once for many requests."""

import asyncio
import time
from typing import Final

from starlette.concurrency import run_in_threadpool

from service.store.keys import KeyBook, KeyRecord, Keys

STALE_S: Final = 0.25
"""So old the keys may be that a request is compared with."""


class KeyRing:
    """Knows what the store says of keys, `STALE_S` late at most. Used in one event loop.

    Keys are made and revoked by other processes too, so what is known is read again, however many
    ask, every `STALE_S`. A revoked key opens nothing from then on, and without a key nobody is
    served from then on once the first was made; a key expires to the moment. One that is not known
    is looked for in the store itself: it may have been made just now.
    """

    def __init__(self, keys: Keys) -> None:
        self._keys = keys
        self._lock = asyncio.Lock()
        self._book = KeyBook({})
        self._read_s = float("-inf")

    async def known(self, key: str) -> KeyRecord | None:
        """Return the record of a key that is good now; None of any other text."""
        record = (await self._now()).known(key)
        return record or await run_in_threadpool(self._keys.known, key)

    async def any(self) -> bool:
        """Tell whether a key was ever made."""
        return bool((await self._now()).by_id)

    async def _now(self) -> KeyBook:
        if self._is_stale():
            async with self._lock:  # one reads for all who wait
                if self._is_stale():
                    began_s = time.monotonic()
                    self._book = await run_in_threadpool(self._keys.read)
                    self._read_s = began_s
        return self._book

    def _is_stale(self) -> bool:
        return time.monotonic() - self._read_s >= STALE_S
