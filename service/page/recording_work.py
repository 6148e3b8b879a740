"""What the service can work out of a recording: each as the API does it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from fastapi import Response

from service.api.answers.job import JobAnswer
from service.api.calibrations import CalibrationRequest, start_calibration
from service.api.dependencies import Parts
from service.store.actor import Actor

Start = Callable[[Parts, str, Actor, bool], JobAnswer]


@dataclass(frozen=True)
class RecordingWork:
    """A kind of job that takes a recording.

    Attributes:
        name: On its button.
        start: Queues it: of the service, the recording's digest, who asks, whether on a relative
            scale.
    """

    name: str
    start: Start


def _calibrate(parts: Parts, digest: str, by: Actor, relative: bool) -> JobAnswer:
    return start_calibration(
        wanted=CalibrationRequest(recording=digest, relative=relative),
        response=Response(),
        store=parts.store,
        settings=parts.settings,
        runner=parts.runner,
        operator=by,
    )


WORK: Final[tuple[RecordingWork, ...]] = (RecordingWork("Calibrate", _calibrate),)
