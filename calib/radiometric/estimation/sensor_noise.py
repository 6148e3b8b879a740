"""System gain and read noise of a set: from photon transfer where it determines them.

Photon transfer (docs/photon-transfer/curve.md) lets the response and the charge bend the curve and
takes K from the model that has both, which the line of `noise_model` cannot. The line stays what
the regression's weights are made of, and stands in where photon transfer does not determine both
figures: without darks, with noise that rounding hides, without blocks that tell.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from calib.errors import NotDeterminedError
from calib.radiometric.coefficients.provenance import Parameter
from calib.radiometric.estimation.noise_model import NoiseModel
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.header import CameraHeader
from calib.transfer.photon_transfer.measure import gain_and_noise
from calib.transfer.photon_transfer.result import PhotonTransfer

PHOTON_TRANSFER, NOISE_LINE = "photon transfer", "noise line"


@dataclass(frozen=True)
class SensorNoise:
    """The noise of a sensor in a set.

    Attributes:
        system_gain_dn_per_e: K, DN per electron.
        system_gain_dn_per_e_std: Its standard uncertainty.
        read_noise_e: σ_r, electrons.
        read_noise_e_std: Its standard uncertainty.
        provenance: Method and model, and why, where it is not photon transfer.
        warnings: What an operator should know.
    """

    system_gain_dn_per_e: float
    system_gain_dn_per_e_std: float
    read_noise_e: float
    read_noise_e_std: float
    provenance: dict[str, Parameter]
    warnings: tuple[str, ...]


def sensor_noise(
    statistics: RecordingStatistics, camera: CameraHeader, line: NoiseModel
) -> SensorNoise:
    """Return gain and read noise by photon transfer, or else those of the noise line."""
    try:
        found = gain_and_noise(statistics, camera)
    except NotDeterminedError as refusal:
        return _of_line(line, str(refusal))
    gain, read = found.system_gain, found.read_noise_e
    if not (gain.is_known and read.is_known):
        return _of_line(line, gain.reason or read.reason)
    told: dict[str, Parameter] = {
        "system_gain_method": PHOTON_TRANSFER,
        "system_gain_model": found.model,
    }
    return SensorNoise(gain.value, gain.std, read.value, read.std, told, tuple(_warnings(found)))


def _of_line(line: NoiseModel, reason: str) -> SensorNoise:
    told: dict[str, Parameter] = {
        "system_gain_method": NOISE_LINE,
        "system_gain_model": "straight",
        "system_gain_reason": reason,
    }
    return SensorNoise(
        line.system_gain_dn_per_e,
        line.system_gain_dn_per_e_std,
        line.read_noise_e,
        line.read_noise_e_std,
        told,
        (),
    )


def _warnings(found: PhotonTransfer) -> Iterator[str]:
    """Yield what is said of the curve and not of the lines, by `findings`, as well."""
    for tap in found.taps:
        model = tap.choice.called_for
        if model.value:
            of = f" of tap {tap.tap}" if len(found.taps) > 1 else ""
            yield f"The photon-transfer curve{of} is {model.label}: {tap.choice.why}."
    if found.curve.defects:
        yield (
            f"{found.curve.defects} columns have another noise than columns of like signal; they "
            "are left out of system gain and read noise."
        )
