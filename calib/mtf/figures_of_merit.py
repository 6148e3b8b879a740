"""What a person asks of a transfer function first: its first zero, its value at Nyquist."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.mtf.estimate import TransferFunction, TransferMap
from calib.transfer.estimate import Estimate

_STEPS = 800
PER_MM = 1e3


@dataclass(frozen=True, eq=False)
class Cut:
    """A transfer function along one axis of the detector, from 0 on.

    Attributes:
        axis: "x" or "y".
        frequency_per_um: (n,).
        values: Each array (n,).
    """

    axis: str
    frequency_per_um: NDArray[np.floating]
    values: TransferMap


def cuts(transfer: TransferFunction, highest_per_um: float) -> Iterator[Cut]:
    """Yield the cuts along x and along y."""
    frequency, zero = np.linspace(0, highest_per_um, _STEPS), np.zeros(1)
    yield Cut("x", frequency, _flat(transfer.at(frequency, zero)))
    yield Cut("y", frequency, _flat(transfer.at(zero, frequency)))


def first_zero(cut: Cut) -> Estimate:
    """Return where the real part first changes its sign, per mm; unknown where it does not."""
    real, usable = cut.values.transfer.real, cut.values.valid
    crossing = (real[:-1] > 0) & (real[1:] <= 0) & usable[:-1] & usable[1:]
    if not crossing.any():
        return Estimate.unknown("1/mm", f"the transfer function keeps its sign along {cut.axis}")
    k = int(np.argmax(crossing))
    low, high = cut.frequency_per_um[k : k + 2]
    slope = (real[k + 1] - real[k]) / (high - low)
    std = cut.values.real_std[k] / abs(slope)
    return Estimate(PER_MM * float(low - real[k] / slope), PER_MM * float(std), "1/mm")


def at_nyquist(transfer: TransferFunction, pitch_um: float) -> dict[str, Estimate]:
    """Return |T| at 1/(2 pitch) along x and along y; unknown where it is not determined."""
    nyquist, zero = np.array([0.5 / pitch_um]), np.zeros(1)
    found = {"x": transfer.at(nyquist, zero), "y": transfer.at(zero, nyquist)}
    return {axis: _modulus(axis, _flat(each)) for axis, each in found.items()}


def _modulus(axis: str, at: TransferMap) -> Estimate:
    if not at.valid[0]:
        why = f"the pattern does not determine Nyquist's frequency along {axis}"
        return Estimate.unknown("1", why)
    return Estimate(float(np.abs(at.transfer[0])), float(at.modulus_std[0]), "1")


def _flat(values: TransferMap) -> TransferMap:
    return TransferMap(
        values.transfer.ravel(),
        values.real_std.ravel(),
        values.imaginary_std.ravel(),
        values.valid.ravel(),
    )
