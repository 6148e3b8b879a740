"""What photon transfer says of a sensor."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.transfer.estimate import Estimate
from calib.transfer.photon_transfer.estimates import gain_estimate, read_noise_dn, read_noise_e
from calib.transfer.photon_transfer.points import Curve
from calib.transfer.photon_transfer.recorded_cells import RecordedCells
from calib.transfer.photon_transfer.remarks import remarks
from calib.transfer.photon_transfer.tap_transfer import TapTransfer


@dataclass(frozen=True)
class PhotonTransfer:
    """A recording's photon transfer.

    The pooled figures are the taps' means, each pixel with the same weight; the errors of taps are
    their own, but for that of the response's bend where an unsteady source makes it.

    Attributes:
        taps: One by one.
        curve: All points.
        recorded: The cells that they come from.
        of_recording: What was odd about the recording.
    """

    taps: tuple[TapTransfer, ...]
    curve: Curve
    recorded: RecordedCells
    of_recording: tuple[str, ...]

    @cached_property
    def _pooled(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (K, σ_r²) and their covariance."""
        share = self.curve.pixels / self.curve.pixels.sum()
        value = sum((w * t.gain_and_read for w, t in zip(share, self.taps, strict=True)), 0.0)
        covariance, shared = np.zeros((2, 2)), np.zeros(2)
        for w, t in zip(share, self.taps, strict=True):
            covariance += w**2 * (t.covariance - np.outer(t.shared, t.shared))
            shared += w * t.shared
        return np.asarray(value), covariance + np.outer(shared, shared)

    @property
    def system_gain(self) -> Estimate:
        """K, pooled over the taps."""
        return gain_estimate(*self._pooled)

    @property
    def read_noise_dn(self) -> Estimate:
        """σ_r before rounding: the root of the taps' mean variance."""
        return read_noise_dn(*self._pooled, has_darks=self.taps[0].has_darks)

    @property
    def read_noise_e(self) -> Estimate:
        """σ_r / K, pooled."""
        return read_noise_e(*self._pooled, has_darks=self.taps[0].has_darks)

    @property
    def read_variance_dn2(self) -> Estimate:
        """σ_r², for a noise model: it may come out negative where rounding is all there is."""
        value, covariance = self._pooled
        return Estimate(float(value[1]), float(np.sqrt(covariance[1, 1])), "DN2")

    @property
    def model(self) -> str:
        """The model that is called for at most taps."""
        labels = [t.choice.called_for.label for t in self.taps]
        return max(dict.fromkeys(labels), key=labels.count)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What limits the figures; one sentence each."""
        return (*self.of_recording, *remarks(self.taps, self.curve, self.recorded))

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {
            "method": "ptc",
            "system_gain_dn_per_e": self.system_gain.answer(),
            "read_noise_e": self.read_noise_e.answer(),
            "read_noise_dn": self.read_noise_dn.answer(),
            "model": self.model,
            "taps": [t.answer() for t in self.taps],
            "source": self.recorded.source,
            "defect_cells": self.curve.defects,
            "warnings": list(self.warnings),
        }
