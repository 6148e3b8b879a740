"""The radiance of a source as a band of given spectral response sees it.

Two quantities go by that name; both are here and never mixed up (docs/spectral-response.md):

    band-integrated   ∫L(λ) R(λ) dλ            W m-2 sr-1       R with its peak at 1; the default
    band-averaged     ∫L(λ) R(λ) dλ / ∫R dλ    W m-2 sr-1 nm-1  whatever the scale of R

Both integrals go by the trapezoidal rule on the union of the two grids.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import InputError
from calib.radiometric.spectral.band_radiance_spectra import LampSpectra
from calib.radiometric.spectral.spectral_response import Figure, SpectralResponse

Quantity = Literal["band-integrated", "band-averaged"]

UNITS: dict[Quantity, str] = {
    "band-integrated": "W m-2 sr-1",
    "band-averaged": "W m-2 sr-1 nm-1",
}


@dataclass(frozen=True)
class BandRadiance:
    """What each lamp alone gives in the band; lamps that burn together add up.

    Attributes:
        quantity: Which of the two definitions.
        radiance: By lamp, in `unit`, (n_lamps,).
        response_covariance: What the response's uncertainty makes of it, (n_lamps, n_lamps).
        source_covariance: What the spectra's and the certificate's make, (n_lamps, n_lamps).
        names: The lamps' names.
    """

    quantity: Quantity
    radiance: Columns
    response_covariance: NDArray[np.float64]
    source_covariance: NDArray[np.float64]
    names: tuple[str, ...]

    @property
    def unit(self) -> str:
        """Unit of the radiance."""
        return UNITS[self.quantity]

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of the lamps' radiances, (n_lamps, n_lamps)."""
        return self.response_covariance + self.source_covariance

    def of_lamps(self, lit: Sequence[int]) -> Figure:
        """Return the radiance while the lamps of these indices burn; errors in common add up."""
        chosen = np.zeros(len(self.radiance))
        chosen[list(lit)] = 1.0
        variance = max(float(chosen @ self.covariance @ chosen), 0.0)
        return Figure(float(chosen @ self.radiance), variance**0.5)

    def by_level(self) -> dict[float, Figure]:
        """Return the radiance by level: at level n the first n lamps burn."""
        return {float(n): self.of_lamps(range(n)) for n in range(1, len(self.radiance) + 1)}

    def table(self) -> dict[float, float]:
        """Return radiance by level, as `calibrate(..., radiances=...)` takes it."""
        return {level: figure.value for level, figure in self.by_level().items()}

    def level_covariance(self) -> NDArray[np.float64]:
        """Return the covariance between levels 1 .. n_lamps, (n_lamps, n_lamps)."""
        lit = np.tril(np.ones_like(self.covariance))
        return np.asarray(lit @ self.covariance @ lit.T, np.float64)


def band_radiance(
    spectra: LampSpectra,
    response: SpectralResponse,
    *,
    quantity: Quantity = "band-integrated",
    correlation_length_nm: float = 0.0,
) -> BandRadiance:
    """Return the lamps' radiance in the band.

    Args:
        spectra: The lamps' spectral radiances.
        response: R(λ).
        quantity: The definition.
        correlation_length_nm: Over which wavelengths the response's errors go together: their
            correlation is exp(-Δλ/length). 0 for independent points (noise), infinity for errors
            of one sign everywhere (the whole curve too high).

    Raises:
        InputError: `spectrum-range`: the spectra do not cover the response.
    """
    low, high = response.wavelength_nm[[0, -1]]
    if spectra.wavelength_nm[0] > low or spectra.wavelength_nm[-1] < high:
        msg = (
            f"The lamps' spectra cover {spectra.wavelength_nm[0]:g} to "
            f"{spectra.wavelength_nm[-1]:g} nm, the response {low:g} to {high:g} nm: they are "
            "never extrapolated; give spectra over the whole response."
        )
        raise InputError(msg, code="spectrum-range")
    inside = (spectra.wavelength_nm > low) & (spectra.wavelength_nm < high)
    grid = np.union1d(response.wavelength_nm, spectra.wavelength_nm[inside])
    weights = _trapezoid_weights(grid)
    on_grid = _interpolation(grid, response.wavelength_nm)
    weighted_response = weights * (on_grid @ response.response)
    lamps = _on_grid(grid, spectra, spectra.radiance)
    lamp_std = _on_grid(grid, spectra, spectra.radiance_std)
    radiance, own_std = lamps @ weighted_response, lamp_std @ weighted_response
    sensitivity = (lamps * weights) @ on_grid
    if quantity == "band-averaged":
        width = weighted_response.sum()
        radiance, own_std = radiance / width, own_std / width
        sensitivity = ((lamps - radiance[:, None]) * weights) @ on_grid / width
    of_response = sensitivity @ _response_covariance(response, correlation_length_nm)
    common = spectra.certificate_relative_std * radiance
    return BandRadiance(
        quantity,
        radiance,
        of_response @ sensitivity.T,
        np.outer(common, common) + np.diag(own_std**2),
        spectra.names,
    )


def _trapezoid_weights(grid: Columns) -> Columns:
    """Return w with sum(w·f) = ∫f by the trapezoidal rule, (n,)."""
    steps = np.diff(grid)
    return np.asarray((np.append(steps, 0.0) + np.append(0.0, steps)) / 2, np.float64)


def _interpolation(grid: Columns, nodes: Columns) -> NDArray[np.float64]:
    """Return the matrix that takes values at `nodes` to straight lines on `grid`."""
    return np.array([np.interp(grid, nodes, unit) for unit in np.eye(len(nodes))]).T


def _on_grid(
    grid: Columns, spectra: LampSpectra, values: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.array([np.interp(grid, spectra.wavelength_nm, lamp) for lamp in values])


def _response_covariance(
    response: SpectralResponse, correlation_length_nm: float
) -> NDArray[np.float64]:
    """Return the covariance of the response's points, (n, n)."""
    if not correlation_length_nm >= 0:
        msg = f"A correlation length of {correlation_length_nm} nm is not one: give 0 or more."
        raise InputError(msg, code="correlation-length")
    distance = np.abs(np.subtract.outer(response.wavelength_nm, response.wavelength_nm))
    if correlation_length_nm == 0:
        correlation = np.eye(len(distance))
    else:
        correlation = np.exp(-distance / correlation_length_nm)
    return np.asarray(correlation * np.outer(response.std, response.std), np.float64)
