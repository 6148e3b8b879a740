"""The world that simulated devices share: what burns, since when, and whether the lens is capped.

Emulated lamps write it, the simulated camera and the monitor read it, from any process: it is a
small memory-mapped file. A lamp's emission approaches its target exponentially, as a filament
warms: e(t) = target + (start - target) exp(-(t - since) / tau), relative to its nominal radiance.
"""

import fcntl
import mmap
import os
import struct
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import exp
from pathlib import Path
from threading import Lock

# Sequence, n_lamps, cap: from, to, at; sensor temperature, target; drift: amplitude, tau, since.
_HEADER = struct.Struct("<qqdddddddd")
_CAP = struct.Struct("<ddd")
_DRIFT = struct.Struct("<ddd")
_CAP_AT, _TEMPERATURE_AT, _TARGET_AT, _DRIFT_AT = 16, 40, 48, 56
_LAMP = struct.Struct("<dddd")  # start, target, since, tau
_LOOKS = 20  # a write takes a few microseconds


@dataclass(frozen=True)
class Lamp:
    """One lamp's way to its target; times on the system-wide monotonic clock, in seconds."""

    start: float = 0.0
    target: float = 0.0
    since_s: float = 0.0
    tau_s: float = 0.0

    def emission(self, at_s: float) -> float:
        """Relative emission at the monotonic time `at_s`."""
        if at_s < self.since_s:
            return self.start
        if self.tau_s <= 0:
            return self.target
        return self.target + (self.start - self.target) * exp(-(at_s - self.since_s) / self.tau_s)


@dataclass(frozen=True)
class LampDrift:
    """What all lamps do together for hours: 1 + amplitude (1 - exp(-(t - since) / tau))."""

    amplitude: float = 0.0
    tau_s: float = 1.0
    since_s: float = 0.0

    def factor(self, at_s: float) -> float:
        """Relative light at the monotonic time `at_s`."""
        return 1.0 + self.amplitude * (1.0 - exp(-max(at_s - self.since_s, 0.0) / self.tau_s))


@dataclass(frozen=True)
class WorldState:
    """A consistent snapshot.

    Attributes:
        lamps: Each by itself.
        capped: Whether the lens is.
        sensor_temperature_c: The sensor's temperature.
        barred: Whether a target with a slit stands before the lens.
        drift: Of all lamps. A camera's model knows it by itself, a monitor does not.
    """

    lamps: tuple[Lamp, ...]
    capped: bool
    sensor_temperature_c: float
    barred: bool = False
    drift: LampDrift = LampDrift()

    def emissions(self, at_s: float | None = None) -> tuple[float, ...]:
        """Relative emission of each lamp, now or at the monotonic time `at_s`."""
        now = time.monotonic() if at_s is None else at_s
        return tuple(lamp.emission(now) for lamp in self.lamps)

    def at_monitor(self) -> tuple[float, ...]:
        """What a monitor sees of each lamp now, drift included."""
        now = time.monotonic()
        factor = self.drift.factor(now)
        return tuple(factor * emission for emission in self.emissions(now))


class World:
    """Writers take turns by a lock on the file; readers look again while a write is under way.

    The file's lock keeps processes apart (and Worlds opened twice in one), `_writing` threads.
    A reader that looked in vain takes its turn as a writer would: a busy machine may have put the
    writer to sleep in the middle, and the lock tells that from a writer that died there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._writing = Lock()
        self._file = os.open(path, os.O_RDWR | os.O_CLOEXEC)
        self._close_file = weakref.finalize(self, os.close, self._file)
        self._map = mmap.mmap(self._file, 0)

    @classmethod
    def create(cls, path: Path, n_lamps: int, *, sensor_temperature_c: float = 25.0) -> "World":
        """Make a dark, uncapped world with `n_lamps` at `path`."""
        body = _HEADER.pack(0, n_lamps, 0.0, 0.0, 0.0, sensor_temperature_c, 0.0, 0.0, 1.0, 0.0)
        part = path.with_name(f".{path.name}.part")
        part.write_bytes(body + _LAMP.pack(0.0, 0.0, 0.0, 0.0) * n_lamps)
        part.replace(path)
        return cls(path)

    def state(self) -> WorldState:
        """Return a consistent snapshot."""
        for _ in range(_LOOKS):
            data = bytes(self._map)
            if _is_whole(data) and data[:8] == self._map[:8]:
                return self._unpack(data)
            time.sleep(1e-4)
        with self._exclusively():
            data = bytes(self._map)
        if not _is_whole(data):
            raise OSError(f"{self.path}: a writer died in the middle of a write; make it anew")
        return self._unpack(data)

    def drive(self, lamp: int, target: float, *, tau_s: float = 0.0) -> None:
        """Send `lamp` from where it is now towards `target`."""
        with self._exclusively():
            now = time.monotonic()
            start = self._unpack(bytes(self._map)).lamps[lamp].emission(now)
            self._write(_HEADER.size + lamp * _LAMP.size, _LAMP.pack(start, target, now, tau_s))

    def cap(self, capped: bool, *, travel_s: float = 0.0) -> None:
        """Put the cap on the lens, or take it off; it arrives after `travel_s`."""
        with self._exclusively():
            now = time.monotonic()
            was = self._unpack(bytes(self._map)).capped
            self._write(_CAP_AT, _CAP.pack(float(was), float(capped), now + travel_s))

    def warm(self, sensor_temperature_c: float) -> None:
        """Set the sensor's temperature."""
        with self._exclusively():
            self._write(_TEMPERATURE_AT, struct.pack("<d", sensor_temperature_c))

    def bar(self, barred: bool) -> None:
        """Put a target with a slit before the lens, or take it away."""
        with self._exclusively():
            self._write(_TARGET_AT, struct.pack("<d", float(barred)))

    def drift(self, amplitude: float, tau_s: float) -> None:
        """Let all lamps drift from now on."""
        with self._exclusively():
            self._write(_DRIFT_AT, _DRIFT.pack(amplitude, tau_s, time.monotonic()))

    def close(self) -> None:
        """Let go of the file; safe to call twice."""
        self._map.close()
        self._close_file()

    def _unpack(self, data: bytes) -> WorldState:
        _, n_lamps, was, becomes, at_s, temperature, barred, *drift = _HEADER.unpack_from(data)
        lamps = tuple(
            Lamp(*_LAMP.unpack_from(data, _HEADER.size + i * _LAMP.size)) for i in range(n_lamps)
        )
        capped = becomes if time.monotonic() >= at_s else was
        return WorldState(lamps, capped > 0, temperature, barred > 0, LampDrift(*drift))

    @contextmanager
    def _exclusively(self) -> Iterator[None]:
        with self._writing:
            fcntl.flock(self._file, fcntl.LOCK_EX)
            try:
                yield
            finally:
                fcntl.flock(self._file, fcntl.LOCK_UN)

    def _write(self, offset: int, data: bytes) -> None:
        # Odd while it is under way; a writer that died left it odd, and the next one mends that.
        sequence = struct.unpack_from("<q", self._map)[0] | 1
        struct.pack_into("<q", self._map, 0, sequence)
        self._map[offset : offset + len(data)] = data
        struct.pack_into("<q", self._map, 0, sequence + 1)


def _is_whole(data: bytes) -> bool:
    """Whether no write was under way: the sequence is even."""
    return data[0] % 2 == 0
