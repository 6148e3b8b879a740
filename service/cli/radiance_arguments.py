"""Radiance by level for `calibrate`: from a table, or from spectra and the camera's response."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from calib.radiometric.coefficients.provenance import Parameter
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.radiometric.spectral.band_radiance_spectra import LampSpectra
from calib.radiometric.spectral.radiances_from_spectra import radiances_from_spectra
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.radiometric.spectral.spectral_response_scan import SpectralScan
from calib.recording.header import RecordingHeader
from service.cli.radiance_csv import read_radiances


@dataclass(frozen=True)
class LevelRadiances:
    """What `calib.radiometric.calibrate` takes; None where the recording itself says it."""

    by_level: Mapping[float, float] | None = None
    unit: str | None = None
    source: SourceUncertainty | None = None
    origin: Mapping[str, Parameter] = field(default_factory=dict)


def level_radiances(
    header: RecordingHeader,
    *,
    table: Path | None,
    lamp_spectra: Path | None,
    spectral_response: Path | None,
    certificate_std: float | None,
    correlation_nm: float,
) -> LevelRadiances:
    """Return the radiances that the options name.

    Args:
        header: The recording's.
        table: A CSV of `level,radiance`.
        lamp_spectra: A CSV of the lamps' spectra; together with `spectral_response`.
        spectral_response: A CSV of the camera's, or the folder of a monochromator scan.
        certificate_std: Of the spectra in common, relative; None takes the header's.
        correlation_nm: Over which the response's errors go together.

    Raises:
        InputError: What is wrong in a file.
    """
    if lamp_spectra is None or spectral_response is None:
        return LevelRadiances(read_radiances(table)) if table else LevelRadiances()
    stated = certificate_std
    if stated is None:
        stated = SourceUncertainty.of_header(header.source).certificate_relative_std or 0.0
    spectra = LampSpectra.load(lamp_spectra, certificate_relative_std=stated)
    found = radiances_from_spectra(
        header, spectra, load_response(spectral_response), correlation_length_nm=correlation_nm
    )
    origin: dict[str, Parameter] = {
        "radiances_from": "band-integrated lamp spectra",
        "lamp_spectra": lamp_spectra.name,
        "lamp_spectra_sha256": _digest(lamp_spectra),
        "spectral_response": spectral_response.name,
        "spectral_response_sha256": _digest(spectral_response),
        "spectral_response_correlation_nm": correlation_nm,
    }
    return LevelRadiances(found.by_level, found.unit, found.source, origin)


def load_response(path: Path) -> SpectralResponse:
    """Return the response in a CSV file, or at normal incidence of the scan in a folder."""
    if path.is_dir():
        return SpectralScan.load(path).at_angle(0.0)
    return SpectralResponse.load(path)


def _digest(path: Path) -> str:
    """Return the SHA-256 of a file, or of a scan's files with their names, in order."""
    if not path.is_dir():
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    digest = hashlib.sha256()
    for each in sorted((*path.glob("*.csv"), *path.glob("frames/*.npy"))):
        digest.update(f"{each.relative_to(path).as_posix()} {_digest(each)}\n".encode())
    return digest.hexdigest()
