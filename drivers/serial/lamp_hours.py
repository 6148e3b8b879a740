"""Lamp hours: how long each lamp has burnt, kept in a small file.

A lamp's radiance falls and its colour changes with the hours that it burns; a certificate holds for
so many hours. They are therefore counted, and survive the program.
"""

import json
import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from threading import RLock

from calib.errors import InputError

_SAVED_EVERY_S = 60.0
_S_PER_HOUR = 3600.0


class LampHours:
    """Counts while lamps are seen burning; saves at every change and once a minute.

    A program that is killed loses at most the last minute. A new lamp: set its hours to 0 in the
    file, `{"1": 12.5, "2": 0.0}`, lamp number to hours. Thread-safe.
    """

    def __init__(
        self, path: Path | None, lamps: range, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Read `path` where it exists; without a path, count for this program only.

        Raises InputError with code `lamp-hours-unreadable`.
        """
        self._path = path
        self._clock = clock
        self._lock = RLock()
        self._hours = dict.fromkeys(lamps, 0.0) | _read(path)
        self._burning_since: dict[int, float] = {}
        self._saved_at = clock()

    def hours(self, lamp: int) -> float:
        """Hours that `lamp` has burnt so far."""
        since = self._burning_since.get(lamp)
        running_s = 0.0 if since is None else self._clock() - since
        return self._hours.get(lamp, 0.0) + running_s / _S_PER_HOUR

    def seen(self, burning: Mapping[int, bool]) -> None:
        """Note which lamps burn now: number to whether it does."""
        with self._lock:
            before = set(self._burning_since)
            for lamp, burns in burning.items():
                self._hours[lamp] = self.hours(lamp)
                if burns:
                    self._burning_since[lamp] = self._clock()
                else:
                    self._burning_since.pop(lamp, None)
            changed = before != set(self._burning_since)
            if changed or self._clock() - self._saved_at >= _SAVED_EVERY_S:
                self.save()

    def save(self) -> None:
        """Write the file whole or not at all."""
        with self._lock:
            self._saved_at = self._clock()
            if self._path is None:
                return
            hours = {str(lamp): self.hours(lamp) for lamp in sorted(self._hours)}
            part = self._path.with_name(f".{self._path.name}.{os.getpid()}")
            with part.open("w") as file:
                file.write(json.dumps(hours, indent=1) + "\n")
                file.flush()
                os.fsync(file.fileno())
            part.replace(self._path)


def _read(path: Path | None) -> dict[int, float]:
    if path is None or not path.exists():
        return {}
    try:
        hours = {int(lamp): float(value) for lamp, value in json.loads(path.read_text()).items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path}: lamp hours cannot be read ({error}); mend it, or move it away to count anew",
            code="lamp-hours-unreadable",
        ) from error
    if not all(0.0 <= value < float("inf") for value in hours.values()):
        raise InputError(
            f"{path}: lamp hours must be 0 or more; mend it, or move it away to count anew",
            code="lamp-hours-unreadable",
        )
    return hours
