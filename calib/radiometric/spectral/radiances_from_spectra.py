"""The radiance of each level, computed from the lamps' spectra and the camera's spectral response.

What comes out is what a table of radiances would have stated, and its uncertainty in the terms of
`SourceUncertainty`: an error that all levels share, and one of each level's own. From the relative
covariance C of the levels that the recording has (JCGM 100:2008, section 5.2):

    shared   s² = mean of C over pairs of different levels
    own      o² = mean of its diagonal - s²

so that the variance of the levels' plain mean, on which the radiance scale hangs, is kept exactly.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.radiometric.estimation.choices import no_flats
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.radiometric.spectral.band_radiance import BandRadiance, band_radiance
from calib.radiometric.spectral.band_radiance_spectra import LampSpectra
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.recording.header import RecordingHeader


@dataclass(frozen=True)
class RadiancesFromSpectra:
    """What `calibrate` takes of it.

    Attributes:
        by_level: Band-integrated radiance, in `unit`.
        unit: W m-2 sr-1.
        source: The source's uncertainty, that of the radiances put in.
    """

    by_level: dict[float, float]
    unit: str
    source: SourceUncertainty


def radiances_from_spectra(
    header: RecordingHeader,
    spectra: LampSpectra,
    response: SpectralResponse,
    *,
    correlation_length_nm: float = 0.0,
) -> RadiancesFromSpectra:
    """Return the radiances of a recording's levels; level n is that of the first n lamps.

    Lamps whose spectra have no uncertainty of their own leave `level_relative_std` as the header
    states it, or, where it does not, to how well the levels agree.

    Args:
        header: The recording's; its radiances and their certificate count no more.
        spectra: The lamps', with the uncertainty of their certificate.
        response: R(λ) of the camera.
        correlation_length_nm: Over which the response's errors go together (`band_radiance`).

    Raises:
        InputError: `levels-not-lamps`, `dark-level` or `spectrum-range`.
    """
    levels = _levels(header, spectra)
    # The certificate's error is exactly common: it stays a number of its own until the end.
    alone = replace(spectra, certificate_relative_std=0.0)
    band = band_radiance(alone, response, correlation_length_nm=correlation_length_nm)
    by_level = {float(level): band.of_lamps(range(level)).value for level in levels}
    for level, radiance in by_level.items():
        if not radiance > 0:
            msg = f"Level {level:g} has no radiance in the band: check spectra and response."
            raise InputError(msg, code="dark-level")
    stated = SourceUncertainty.of_header(header.source)
    return RadiancesFromSpectra(by_level, band.unit, _source(stated, spectra, band, levels))


def _levels(header: RecordingHeader, spectra: LampSpectra) -> list[int]:
    """Return the levels of the flats, each a number of lamps that have a spectrum."""
    n_lamps = len(spectra.names)
    flats = [block for block in header.blocks if block.kind == "flat"]
    if not flats:
        raise no_flats()
    if header.source.kind == "led":
        msg = (
            "The source is an LED, whose level is a setting and not a number of lamps: state its "
            "radiances by level instead of spectra."
        )
        raise InputError(msg, code="levels-not-lamps")
    for block in flats:
        if block.level not in range(1, n_lamps + 1):
            msg = (
                f"Block {block.block} is a flat of level {block.level:g}, and the spectra are of "
                f"{n_lamps} lamps: a level must be how many of them burn, the first ones first; "
                "add the missing lamps, or state the radiances by level."
            )
            raise InputError(msg, code="levels-not-lamps")
    return sorted({int(block.level) for block in flats})


def _source(
    stated: SourceUncertainty, spectra: LampSpectra, band: BandRadiance, levels: Sequence[int]
) -> SourceUncertainty:
    """Return what is stated of the source, with the uncertainty of the computed radiances."""
    by_response = _shared_and_own(band, band.response_covariance, levels)
    by_lamps = _shared_and_own(band, band.source_covariance, levels)
    level_relative_std = stated.level_relative_std
    if spectra.radiance_std.any():
        level_relative_std = float(np.hypot(by_response[1], by_lamps[1]))
    return replace(
        stated,
        # None is "not stated"; a certificate without any uncertainty has stated none.
        certificate_relative_std=float(np.hypot(spectra.certificate_relative_std, by_lamps[0]))
        or None,
        level_relative_std=level_relative_std,
        spectral_response_relative_std=by_response[0],
    )


def _shared_and_own(
    band: BandRadiance, covariance: NDArray[np.float64], levels: Sequence[int]
) -> tuple[float, float]:
    """Return relative standard uncertainties: what the levels share, and each level's own.

    Args:
        band: The lamps' radiances.
        covariance: Of the lamps' radiances, (n_lamps, n_lamps).
        levels: How many of the first lamps burn, one number per level.
    """
    lit = np.arange(len(band.radiance)) < np.array(levels)[:, None]
    relative = lit / (lit @ band.radiance)[:, None]
    of_levels = relative @ covariance @ relative.T
    n = len(levels)
    mean_variance = float(np.trace(of_levels)) / n
    if n == 1:
        return mean_variance**0.5, 0.0
    shared = max((float(of_levels.sum()) - n * mean_variance) / (n * (n - 1)), 0.0)
    return shared**0.5, max(mean_variance - shared, 0.0) ** 0.5
