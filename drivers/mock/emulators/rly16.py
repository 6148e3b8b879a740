"""An emulated Devantech USB-RLY16 whose relay moves the cap of the world's lens."""

from drivers.mock.emulators.pty_line import Reply
from drivers.mock.world import World

_MODULE_ID, _VERSION = 9, 1


class Rly16:
    """Eight relays; one moves a cap, which takes `travel_s` to arrive.

    Attributes:
        stuck: The relay board hears, but its relays do not move.
    """

    def __init__(
        self,
        world: World,
        *,
        relay: int = 1,
        capped_when_on: bool = True,
        travel_s: float = 0.1,
    ) -> None:
        self.stuck = False
        self._world = world
        self._mask = 1 << (relay - 1)
        self._capped_when_on = capped_when_on
        self._travel_s = travel_s
        self._states = 0
        self._awaits_states = False
        self._move_cap()

    def receive(self, data: bytes) -> list[Reply]:
        """Every byte is a command, but the one after 5C."""
        answers = b"".join(self._obey(byte) for byte in data)
        return [Reply(answers)] if answers else []

    def tick(self) -> None:
        """Nothing happens by itself: the world knows when the cap arrives."""

    def _obey(self, byte: int) -> bytes:
        if self._awaits_states:
            self._awaits_states = False
            self._move(byte)
        elif byte == 0x5A:
            return bytes([_MODULE_ID, _VERSION])
        elif byte == 0x5B:
            return bytes([self._states])
        elif byte == 0x5C:
            self._awaits_states = True
        elif byte == 0x5D:
            return bytes([125])  # supply voltage, 0.1 V
        elif 0x64 <= byte <= 0x6C:
            self._move(self._states | _relays(byte - 0x64))
        elif 0x6E <= byte <= 0x76:
            self._move(self._states & ~_relays(byte - 0x6E))
        return b""

    def _move(self, states: int) -> None:
        if not self.stuck and states != self._states:
            self._states = states
            self._move_cap()

    def _move_cap(self) -> None:
        on = bool(self._states & self._mask)
        self._world.cap(on == self._capped_when_on, travel_s=self._travel_s)


def _relays(number: int) -> int:
    """The bit of relay `number`, all bits for 0."""
    return 1 << (number - 1) if number else 0xFF
