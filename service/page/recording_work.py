"""What the service can work out of a recording: each as the API does it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from fastapi import Response

from service.api.answers.job import JobAnswer
from service.api.calibrations import CalibrationRequest, start_calibration
from service.api.dependencies import Parts
from service.api.diagnoses import DiagnosisRequest, start_diagnosis
from service.api.photon_transfers import PhotonTransferRequest, start_photon_transfer
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
    wanted = CalibrationRequest(recording=digest, relative=relative)
    return start_calibration(wanted=wanted, response=Response(), known=parts, operator=by)


def _photon_transfer(parts: Parts, digest: str, by: Actor, relative: bool) -> JobAnswer:
    del relative  # a calibration's choice
    wanted = PhotonTransferRequest(recording=digest)
    return start_photon_transfer(wanted=wanted, response=Response(), known=parts, _operator=by)


def _diagnose(parts: Parts, digest: str, by: Actor, relative: bool) -> JobAnswer:
    del relative
    wanted = DiagnosisRequest(recording=digest)
    return start_diagnosis(wanted=wanted, response=Response(), known=parts, _operator=by)


WORK: Final[tuple[RecordingWork, ...]] = (
    RecordingWork("Calibrate", _calibrate),
    RecordingWork("Photon transfer", _photon_transfer),
    RecordingWork("Diagnose", _diagnose),
)
