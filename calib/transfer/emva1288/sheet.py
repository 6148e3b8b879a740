"""The data sheet: every figure with its uncertainty, and the curves that it was read from."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.recording.header import RecordingHeader
from calib.transfer.emva1288.catalogue import CATALOGUE
from calib.transfer.emva1288.spatial_curves import SpatialCurves
from calib.transfer.estimate import Estimate

Numbers = NDArray[np.float64]
METHOD = "EMVA Standard 1288, Release 4.0 Linear"


@dataclass(frozen=True)
class TransferCurve:
    """The flats in the order of their signal, each (n_flats,); DN and DN².

    Attributes:
        light: Exposure times level, µs.
        photons: Per pixel; None where the source states none.
        signal_dn: µ_y − µ_y.dark.
        signal_std: Its standard uncertainty.
        variance_dn2: σ²_y − σ²_y.dark.
        variance_std: Its standard uncertainty.
        noise_dn: σ_y.
        share_at_full_scale: Of the samples.
        in_transfer: Whether in 0 … 70 % of saturation: K and R are from these.
        deviation_percent: From the straight line; NaN outside 5 … 95 %.
        deviation_std: Its standard uncertainty.
        line: Offset and slope of that straight line against `light`, DN and DN/µs.
    """

    light: Numbers
    photons: Numbers | None
    signal_dn: Numbers
    signal_std: Numbers
    variance_dn2: Numbers
    variance_std: Numbers
    noise_dn: Numbers
    share_at_full_scale: Numbers
    in_transfer: NDArray[np.bool_]
    deviation_percent: Numbers
    deviation_std: Numbers
    line: tuple[float, float]


@dataclass(frozen=True)
class DarkCurve:
    """The darks in the order of acquisition, each (n_darks,).

    Attributes:
        exposure_us: Of each.
        temperature_c: Of the sensor; NaN where unknown.
        mean_dn: µ_y.dark.
        mean_std: Its standard uncertainty.
        variance_dn2: σ²_y.dark.
        variance_std: Its standard uncertainty.
        currents_e_per_s: By temperature, °C, where there are several.
    """

    exposure_us: Numbers
    temperature_c: Numbers
    mean_dn: Numbers
    mean_std: Numbers
    variance_dn2: Numbers
    variance_std: Numbers
    currents_e_per_s: Mapping[float, Estimate]


@dataclass(frozen=True)
class DataSheet:
    """What EMVA 1288 asks of a camera.

    Attributes:
        header: The recording's.
        recording: Its name.
        figures: By the catalogue's names; those that are not determined say why.
        response_dn_per_light: Slope of the signal against `transfer.light`, DN/µs.
        photon_scale_relative_std: Type B, common to all figures in photons; None: not stated.
        transfer: The flats.
        darks: The darks.
        spatial: The averaged images' profiles, spectrograms and histograms; None without frames.
        warnings: What was odd but usable; one sentence each.
    """

    header: RecordingHeader
    recording: str
    figures: Mapping[str, Estimate]
    response_dn_per_light: Estimate
    photon_scale_relative_std: float | None
    transfer: TransferCurve
    darks: DarkCurve
    spatial: SpatialCurves | None
    warnings: tuple[str, ...]

    def __getitem__(self, name: str) -> Estimate:
        """Return the figure of this name."""
        return self.figures[name]

    def answer(self) -> dict[str, Any]:
        """Return every figure as JSON has it, named and ordered as in the catalogue."""
        scaled = [c.name for c in CATALOGUE if c.scaled_by_photons]
        currents = {f"{c:g}": e.answer() for c, e in self.darks.currents_e_per_s.items()}
        return {
            "method": METHOD,
            "recording": self.recording,
            **{name: estimate.answer() for name, estimate in self.figures.items()},
            "dark_current_e_per_s_by_temperature_c": currents,
            "photon_scale": {
                "relative_std": self.photon_scale_relative_std,
                "type": "B",
                "not_included_in": scaled,
            },
            "warnings": list(self.warnings),
        }
