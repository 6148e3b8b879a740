"""Emulated GEN supplies on one line: the addressed one answers, an absent one stays silent."""

import time
from collections.abc import Callable, Mapping

from drivers.mock.emulators.gen_supply import GenSupply
from drivers.mock.emulators.pty_line import Reply


class GenChain:
    """Splits bytes into commands and hands them to the supply that is addressed.

    What comes before the newly addressed supply listens (`address_settle_s`) is lost.
    """

    def __init__(
        self,
        supplies: Mapping[int, GenSupply],
        *,
        address_settle_s: float = 0.1,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.supplies = dict(supplies)
        self._settle_s = address_settle_s
        self._clock = clock
        self._addressed: int | None = None
        self._listens_from = 0.0
        self._pending = b""
        self._previous = b"OK\r"

    def receive(self, data: bytes) -> list[Reply]:
        """Commands end with CR; LF is ignored."""
        *commands, self._pending = (self._pending + data.replace(b"\n", b"")).split(b"\r")
        replies = [self._obey(command.decode("ascii", "replace")) for command in commands]
        return [Reply(reply) for reply in replies if reply]

    def tick(self) -> None:
        """Nothing moves by itself."""

    def _obey(self, command: str) -> bytes:
        command = command.strip().upper()
        if command.startswith("ADR "):
            return self._address(command)
        if command in ("GOUT OFF", "GOUT ON", "GRST"):
            self._all(command)
            return b""
        if self._addressed is None or self._clock() < self._listens_from:
            return b""
        if command != "\\":
            answer = self.supplies[self._addressed].obey(command) if command else "OK"
            self._previous = answer.encode("ascii") + b"\r"
        return self._previous

    def _address(self, command: str) -> bytes:
        self._addressed = None
        number = command.removeprefix("ADR ").strip()
        if not number.isdigit() or int(number) not in self.supplies:
            return b""
        self._addressed = int(number)
        self._listens_from = self._clock() + self._settle_s
        return b"OK\r"

    def _all(self, command: str) -> None:
        for supply in self.supplies.values():
            if command == "GRST":
                supply.obey("RST")
            else:
                supply.switch(on=command == "GOUT ON")
