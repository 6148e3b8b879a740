"""Clients that cost little themselves: HTTP/1.1 over one kept connection each, all in one thread.

A client library takes as long to ask as the service to answer, and both share this machine.
"""

import asyncio
import random
import re
import time
from collections import Counter
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Self
from urllib.parse import urlsplit

_PATIENCE_S = 30.0
_LENGTH = re.compile(rb"\r\ncontent-length: *(\d+)\r\n", re.IGNORECASE)
_NUMBER = re.compile(rb"^id: (\d+)$", re.MULTILINE)
_LOST = (OSError, EOFError, TimeoutError)


@dataclass
class Seen:
    """What the clients saw.

    Attributes:
        took_s: Of each answer.
        errors: How often, by kind.
        streams: The numbers of the events of each stream.
    """

    took_s: list[float] = field(default_factory=list)
    errors: Counter[str] = field(default_factory=Counter)
    streams: list[list[int]] = field(default_factory=list)


class Line:
    """One connection to the service."""

    def __init__(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, headers: str
    ) -> None:
        self._reader = reader
        self._writer = writer
        self._headers = headers

    @classmethod
    async def open(cls, url: str, key: str) -> Self:
        place = urlsplit(url)
        reader, writer = await asyncio.open_connection(place.hostname, place.port)
        return cls(reader, writer, f"Host: {place.netloc}\r\nAuthorization: Bearer {key}\r\n")

    async def get(self, path: str) -> int:
        """Read an answer to its end; return its status."""
        async with asyncio.timeout(_PATIENCE_S):
            head = await self._ask(path)
            length = _LENGTH.search(head)
            assert length is not None, head
            await self._reader.readexactly(int(length[1]))
        return _status(head)

    async def events(self, path: str) -> AsyncIterator[int]:
        """Yield the number of each event of a stream, which comes in chunks."""
        head = await self._ask(path)
        if _status(head) != 200:
            raise ConnectionRefusedError(head)
        while size := int(await self._reader.readline(), 16):
            chunk = await self._reader.readexactly(size + 2)
            for number in _NUMBER.findall(chunk):
                yield int(number)

    def close(self) -> None:
        self._writer.close()

    async def _ask(self, path: str) -> bytes:
        self._writer.write(f"GET {path} HTTP/1.1\r\n{self._headers}\r\n".encode())
        return await self._reader.readuntil(b"\r\n\r\n")


async def poll(url: str, key: str, path: str, until_s: float, seen: Seen) -> None:
    """Ask once a second until `until_s` (monotonic), at a phase of its own."""
    await asyncio.sleep(random.random())
    line = await Line.open(url, key)
    while (began_s := time.monotonic()) < until_s:
        try:
            status = await line.get(path)
            if status != 200:
                seen.errors[str(status)] += 1
        except _LOST as error:
            seen.errors[type(error).__name__] += 1
            line.close()
            line = await Line.open(url, key)
        took_s = time.monotonic() - began_s
        seen.took_s.append(took_s)
        await asyncio.sleep(max(0.0, 1.0 - took_s))
    line.close()


async def follow(url: str, key: str, path: str, seen: Seen) -> None:
    """Read a run's events to their end."""
    numbers: list[int] = []
    seen.streams.append(numbers)
    line = await Line.open(url, key)
    try:
        async for number in line.events(path):
            numbers.append(number)  # noqa: PERF401  (what came before it broke counts)
    except _LOST as error:
        seen.errors[f"stream: {type(error).__name__}"] += 1
    line.close()


def _status(head: bytes) -> int:
    return int(head.split(b" ", 2)[1])
