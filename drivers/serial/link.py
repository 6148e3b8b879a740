"""One conversation at a time over one serial port: framing, deadlines, resynchronisation.

**Time.** pyserial's own time-out counts per byte; a link keeps a deadline around the whole reply.

**Step.** After a time-out or a garbled reply the device may still answer the old question. The link
is then *out of step*: before the next question it waits until the line is quiet, asks something
whose answer it knows (`Sync`), and throws away all that comes before that answer.

**Loss.** A call during which the port disappears raises DeviceLostError; nothing is retried behind
the caller's back. The next call tries once to open the same address again, and goes on only after
the known device has answered there; so lamps can be switched off as soon as the line is back.
"""

import re
import time
from collections import Counter
from threading import Lock, RLock

from drivers.errors import DeviceError, DeviceTimeoutError, ProtocolError
from drivers.serial.port import PortSettings, SerialPort
from drivers.serial.sync import Sync

_LINE_ENDS = re.compile(rb"[\r\n]")
_BABBLE_S = 2.0  # longer than any reply: who talks on after this does not stop


class SerialLink:
    """Questions and answers on one port, which it holds exclusively.

    Attributes:
        lock: Held during an exchange; hold it around exchanges that belong together.
        in_step: False when a late reply may still be on its way.
        sync: How to get back into step; None where the caller synchronises by itself.
    """

    def __init__(
        self, settings: PortSettings, *, end: str, timeout_s: float = 1.0, sync: Sync | None = None
    ) -> None:
        """Open the port; `end` terminates every command. Raises what SerialPort raises."""
        self.lock = RLock()
        self.in_step = False
        self.sync = sync
        self.timeout_s = timeout_s
        self.port = SerialPort(settings)
        self._end = end.encode("ascii")
        self._quiet_s = max(0.05, 200.0 / settings.baudrate)
        self._writing = Lock()
        self._asked: Counter[bytes] = Counter()

    @property
    def device(self) -> str:
        """The device's name and address, for messages."""
        return self.port.device

    def query(self, command: str, *, timeout_s: float | None = None) -> str:
        """Send `command`; return the reply's line without its end.

        Raises:
            DeviceTimeoutError: No whole line within `timeout_s`.
            DeviceLostError: The port disappeared, or is still gone.
            ProtocolError: The reply is not printable ASCII.
        """
        limit_s = self.timeout_s if timeout_s is None else timeout_s
        with self.lock:
            self._get_into_step()
            self._ask(command.encode("ascii") + self._end)
            return self._read_line(command, limit_s)

    def query_bytes(self, question: bytes, n_reply: int) -> bytes:
        """Send `question`; return its reply of exactly `n_reply` bytes.

        Bytes beyond these answer something else, and nothing says which came first: the link is
        out of step when some come with the reply (ProtocolError) or lie there before the question.
        Raises besides as `query` does.
        """
        with self.lock:
            if self.ready() and self.port.has_input():
                self.in_step = False
            self._get_into_step()
            self._ask(question)
            deadline = time.monotonic() + self.timeout_s
            while len(self.port.received) < n_reply:
                self._read_before(deadline, repr(question))
            reply = bytes(self.port.received)
            if len(reply) > n_reply:
                raise self.protocol_error(f"{reply!r} is longer than a reply to {question!r}")
            self._answered()
            return reply

    def send(self, command: str) -> None:
        """Send `command`, to which nothing answers. Needs no step."""
        with self.lock:
            self.ready()
            self.interject(command)

    def send_bytes(self, data: bytes) -> None:
        """Send `data`, to which nothing answers. Needs no step."""
        with self.lock:
            self.ready()
            self._write(data)

    def interject(self, command: str) -> None:
        """Send `command` at once, even while another thread waits for a reply.

        Only for commands that nothing answers and that may be sent twice. Does not open a lost
        port again, for which the lock would be needed.
        """
        with self._writing:
            self.port.write(command.encode("ascii") + self._end)

    def protocol_error(self, message: str, *, code: str = "reply-garbled") -> ProtocolError:
        """Return the error for a reply that makes no sense; the link is then out of step."""
        self.in_step = False
        return ProtocolError(
            f"{self.device}: {message}",
            device=self.device,
            code=code,
            last_exchange=self.port.last_exchange,
        )

    def synchronise(self, sync: Sync) -> bytes:
        """Get into step: discard what is late, until the answer that only `sync` gives.

        Returns the answer. Raises DeviceTimeoutError when it does not come.
        """
        with self.lock:
            self.ready()
            self.in_step = False
            self._write(sync.clear)
            self.discard_until_quiet()
            if sync.preamble_answer is not None:
                self._write(sync.preamble)
                self._await(sync.preamble_answer, 1, sync.preamble)
                time.sleep(sync.preamble_s)
            self._asked[sync.question] += 1
            self.port.received.clear()
            self._write(sync.question)
            answer = self._await(sync.answer, self._asked[sync.question], sync.question)
            self._answered()
            return answer

    def discard_until_quiet(self) -> None:
        """Throw away what arrives until nothing comes for 20 characters' time."""
        with self.lock:
            until = time.monotonic() + _BABBLE_S
            quiet_since = time.monotonic()
            while time.monotonic() < until and time.monotonic() - quiet_since < self._quiet_s:
                if self.port.read_some():
                    quiet_since = time.monotonic()
            self.port.received.clear()

    def close(self) -> None:
        """Let go of the port; safe to call twice."""
        with self.lock:
            self.port.close()

    def ready(self) -> bool:
        """Open a lost port again where needed; return whether the next question may be asked."""
        with self.lock:
            if self.port.ensure_open():
                self.in_step = False
            return self.in_step

    def _get_into_step(self) -> None:
        if self.ready():
            return
        if self.sync is None:
            raise DeviceError(
                f"{self.device}: a late reply may be on its way; synchronise first",
                device=self.device,
                code="out-of-step",
            )
        self.synchronise(self.sync)

    def _ask(self, question: bytes) -> None:
        self.in_step = False  # until the whole reply is here
        self._asked[question] += 1
        self.port.discard_input()
        self._write(question)

    def _write(self, data: bytes) -> None:
        if data:
            with self._writing:
                self.port.write(data)

    def _read_line(self, command: str, limit_s: float) -> str:
        """Return the first line that is neither empty nor the command's own echo."""
        deadline = time.monotonic() + limit_s
        while True:
            for line in _LINE_ENDS.split(bytes(self.port.received))[:-1]:
                if line and line != command.encode("ascii"):
                    return self._text(line)
            self._read_before(deadline, repr(command))

    def _text(self, line: bytes) -> str:
        if not (line.isascii() and line.decode("ascii").isprintable()):
            raise self.protocol_error(f"garbled reply {line!r}")
        self._answered()
        return line.decode("ascii").strip()

    def _answered(self) -> None:
        self._asked.clear()
        self.in_step = True

    def _read_before(self, deadline: float, what: str) -> None:
        if not self.port.read_some() and time.monotonic() >= deadline:
            raise self._no_reply(what)

    def _await(self, pattern: re.Pattern[bytes], n_asked: int, question: bytes) -> bytes:
        """Read until `n_asked` answers came, or at least one and then none for long enough."""
        n_answers, heard = 0, time.monotonic()
        while True:
            answers = [match.group() for match in pattern.finditer(self.port.received)]
            if len(answers) > n_answers:
                n_answers, heard = len(answers), time.monotonic()
            if n_answers >= n_asked:
                return answers[-1]
            if time.monotonic() - heard >= self.timeout_s:
                if answers:
                    return answers[-1]
                raise self._no_reply(repr(question))
            self.port.read_some()

    def _no_reply(self, what: str) -> DeviceTimeoutError:
        return DeviceTimeoutError(
            f"{self.device}: no whole reply to {what} in time; "
            "is it switched on, and is the baud rate right?",
            device=self.device,
            code="device-timeout",
            last_exchange=self.port.last_exchange,
        )
