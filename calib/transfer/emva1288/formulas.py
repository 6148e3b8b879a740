"""The standard's formulas, for many variants of the measured numbers at once.

Source: EMVA Standard 1288, Release 4.0 Linear; equation numbers are its own.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from calib.transfer.emva1288.dark_current import dark_currents
from calib.transfer.emva1288.fits import Fits
from calib.transfer.emva1288.inputs import Measured, unpacked
from calib.transfer.emva1288.nonuniformity import SpatialInputs, nonuniformities
from calib.transfer.emva1288.propagation import Batch
from calib.transfer.emva1288.saturation import SaturationPoint
from calib.transfer.emva1288.series import Series

QUANTISATION_DN2 = 1.0 / 12.0
LEAST_DARK_DN2 = 0.24
"""Below it quantisation hides the dark noise (Eqs. 53, 54), which is then under 0.40 DN."""
DARK_LIMIT_DN = 0.40


@dataclass(frozen=True)
class Formulas:
    """Everything but the measured numbers."""

    series: Series
    point: SaturationPoint
    fits: Fits
    photons_per_light: float | None
    spatial: SpatialInputs | None

    def __call__(self, batch: Batch) -> dict[str, Batch]:
        """Return each figure's (n_variants,) by name, as far as there are any."""
        measured = unpacked(batch, self.series, self.spatial)
        found = dict(self._transfer(measured))
        found.update(self._saturation(measured, found))
        found.update(self._linearity(measured))
        gain = found["system_gain_dn_per_e"]
        found.update(dark_currents(self.series, self.fits, measured, gain))
        if self.spatial is not None:
            signal = self.signal(measured)[..., self.spatial.flat_index]
            found.update(nonuniformities(self.spatial, measured.spatial, signal, gain))
        return found

    def signal(self, measured: Measured) -> Batch:
        """Return µ_y − µ_y.dark of each flat."""
        return measured.flat_mean - measured.dark_mean[..., self.series.dark_of]

    def excess(self, measured: Measured) -> Batch:
        """Return σ²_y − σ²_y.dark of each flat."""
        return measured.flat_variance - measured.dark_variance[..., self.series.dark_of]

    def _transfer(self, measured: Measured) -> Iterator[tuple[str, Batch]]:
        """Eqs. 49, 50, 52, 53: lines through the origin over 0 … 70 % of saturation."""
        use = self.fits.transfer
        x, y, h = self.signal(measured)[..., use], self.excess(measured)[..., use], self._light[use]
        gain = np.sum(x * y, axis=-1) / np.sum(x**2, axis=-1) * (1.0 + measured.gain_misfit)
        slope = np.sum(x * h, axis=-1) / np.sum(h**2) * (1.0 + measured.response_misfit)
        line = self.fits.variances[self.series.own_temperature]
        dark = measured.dark_variance[..., list(line.darks)] @ line.intercept
        yield "system_gain_dn_per_e", gain
        yield "inverse_system_gain_e_per_dn", 1.0 / gain
        yield "response_dn_per_light", slope
        yield "electrons_per_light", slope / gain
        if self.photons_per_light is not None:
            yield "responsivity_dn_per_photon", slope / self.photons_per_light
            yield "quantum_efficiency", slope / gain / self.photons_per_light
        yield "temporal_dark_variance_dn2", dark
        yield "temporal_dark_noise_dn", np.sqrt(dark)
        yield "read_noise_dn", np.sqrt(dark - QUANTISATION_DN2)
        yield "read_noise_e", np.sqrt(dark - QUANTISATION_DN2) / gain
        # Eq. 27: SNR = 1, quantisation included; never below one electron.
        yield "sensitivity_threshold_e", np.sqrt(dark / gain**2 + 0.25) + 0.5

    def _saturation(
        self, measured: Measured, found: dict[str, Batch]
    ) -> Iterator[tuple[str, Batch]]:
        """Section 6.6, Eqs. 24, 28."""
        least = found["sensitivity_threshold_e"]
        if self.photons_per_light is not None:
            yield "sensitivity_threshold_photons", least / found["quantum_efficiency"]
        k = self.point.step
        if k < 0:
            return
        dark = measured.dark_mean[..., self.series.dark_of[k]]
        signal = measured.saturation - dark
        light = signal / self.signal(measured)[..., k] * self._light[k]
        electrons = light * found["electrons_per_light"]
        yield "saturation_dn", measured.saturation
        yield "saturation_capacity_e", electrons
        if self.photons_per_light is not None:
            yield "saturation_capacity_photons", light * self.photons_per_light
        yield from _ratios("snr_max", np.sqrt(electrons))
        yield from _ratios("dynamic_range", electrons / least)

    def _linearity(self, measured: Measured) -> Iterator[tuple[str, Batch]]:
        """Eqs. 57-63: the line of least relative deviation over 5 … 95 % of saturation."""
        use = self.fits.linearity
        if self.point.step < 0 or len(use) < 3:
            return
        y, h = self.signal(measured)[..., use], self._light[use]
        offset, slope = relative_line(h, y)
        line = offset[..., None] + slope[..., None] * h
        deviation = 100.0 * (y - line) / line
        yield "linearity_error_percent", np.mean(np.abs(deviation), axis=-1)
        yield "linearity_error_min_percent", np.min(deviation, axis=-1)
        yield "linearity_error_max_percent", np.max(deviation, axis=-1)
        for number, index in enumerate(use):
            yield f"deviation_percent {index}", deviation[..., number]

    @property
    def _light(self) -> Batch:
        return self.series.light


def relative_line(light: Batch, signal: Batch) -> tuple[Batch, Batch]:
    """Return offset and slope of the line that leaves the least Σ ((y − line)/y)², Eqs. 59-61."""
    weight = signal**-2.0
    total = np.sum(weight, axis=-1)
    centre = np.sum(weight * light, axis=-1) / total
    middle = np.sum(weight * signal, axis=-1) / total
    off = light - centre[..., None]
    slope = np.sum(weight * off * signal, axis=-1) / np.sum(weight * off**2, axis=-1)
    return middle - slope * centre, slope


def _ratios(name: str, ratio: Batch) -> Iterator[tuple[str, Batch]]:
    yield name, ratio
    yield f"{name}_db", 20.0 * np.log10(ratio)
    yield f"{name}_bits", np.log2(ratio)
