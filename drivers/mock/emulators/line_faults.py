"""What can go wrong on a line, on command."""

from dataclasses import dataclass


@dataclass
class LineFaults:
    """Faults of one line; whoever injects them writes here, the line reads.

    Attributes:
        garble: So many replies to come have every second character's highest bit flipped.
        truncate: So many replies to come lose their second half, terminator included.
        delay: So many replies to come are late by `delay_s`.
        silent: Everything is obeyed, nothing is answered.
        deaf: Nothing is heard at all.
    """

    garble: int = 0
    truncate: int = 0
    delay: int = 0
    delay_s: float = 0.0
    silent: bool = False
    deaf: bool = False

    def clear(self) -> None:
        """Mend the line."""
        self.garble = self.truncate = self.delay = 0
        self.silent = self.deaf = False

    def spoil(self, reply: bytes) -> tuple[bytes, float]:
        """Return what becomes of `reply`, and by how many seconds it is late."""
        late_s = 0.0
        if self.delay > 0:
            self.delay -= 1
            late_s = self.delay_s
        if self.garble > 0:
            self.garble -= 1
            reply = bytes(
                byte if i % 2 or byte in b"\r\n" else byte ^ 0x80 for i, byte in enumerate(reply)
            )
        if self.truncate > 0:
            self.truncate -= 1
            reply = reply[: len(reply) // 2]
        return (b"" if self.silent else reply), late_s
