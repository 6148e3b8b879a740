"""What is said between the service and the process that owns the bench. All of it is plain."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.arrays import Columns
from calib.errors import DarkflatError
from drivers.errors import DeviceError
from service.sequencer.events import Progress, RunResult


@dataclass(frozen=True)
class Measure:
    """Run a plan into a recording, or go on with it where it is there already."""

    run_id: str
    plan: dict[str, Any]
    out: Path


@dataclass(frozen=True)
class Pause:
    """Hold the run."""


@dataclass(frozen=True)
class Resume:
    """Let a run that is held go on."""


@dataclass(frozen=True)
class Abort:
    """End the run."""


@dataclass(frozen=True)
class SafeOff:
    """End the run and switch every lamp off; `number` comes back with the answer."""

    number: int


@dataclass(frozen=True)
class Look:
    """Ask every device how it is; `number` comes back with the answer."""

    number: int


@dataclass(frozen=True)
class Leave:
    """End the run, close the bench, and end the process."""


Command = Measure | Pause | Resume | Abort | SafeOff | Look | Leave


@dataclass(frozen=True)
class Trouble:
    """An error that crossed from one process to the other."""

    code: str
    message: str
    device: str = ""
    last_exchange: str = ""

    @classmethod
    def of(cls, error: DarkflatError) -> "Trouble":
        """Return what is said of `error`."""
        if isinstance(error, DeviceError):
            return cls(error.code, str(error), error.device, error.last_exchange)
        return cls(error.code, str(error))

    def error(self) -> DarkflatError:
        """Return the error that is raised on this side."""
        if self.device:
            return DeviceError(
                self.message, device=self.device, code=self.code, last_exchange=self.last_exchange
            )
        return DarkflatError(self.message, code=self.code)


DIED = Trouble(
    "bench-process-died",
    "the bench's process died; its lamps are switched off when it is opened again",
)


@dataclass(frozen=True)
class DeviceLook:
    """One device, as it says it is: `values` by name, a number's name carries its unit."""

    role: str
    identity: str
    values: dict[str, float | str | bool | None]
    trouble: Trouble | None = None


@dataclass(frozen=True)
class BenchLook:
    """The whole bench."""

    bench_id: str
    devices: tuple[DeviceLook, ...]


@dataclass(frozen=True)
class Waiting:
    """Somebody else has the bench; the process opens it as soon as they let go."""

    trouble: Trouble


@dataclass(frozen=True)
class Opened:
    """The bench is open and dark."""

    look: BenchLook


@dataclass(frozen=True)
class Refused:
    """The bench could not be opened; the process ends."""

    trouble: Trouble


@dataclass(frozen=True)
class Said:
    """Where the run stands."""

    run_id: str
    progress: Progress


@dataclass(frozen=True)
class Seen:
    """What the frame just taken looks like: mean DN of each `every`-th column, some hundred."""

    run_id: str
    block: str
    mean_dn: Columns
    every: int = 1


@dataclass(frozen=True)
class Ended:
    """The run is over, the bench dark and free; `digest` is that of a whole recording."""

    run_id: str
    result: RunResult | None = None
    digest: str = ""
    trouble: Trouble | None = None


@dataclass(frozen=True)
class Answer:
    """What a numbered question brought; each device's own trouble is in its look."""

    number: int
    look: BenchLook


Report = Waiting | Opened | Refused | Said | Seen | Ended | Answer
