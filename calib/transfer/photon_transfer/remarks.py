"""What a reader of the figures should know: one sentence each."""

from collections.abc import Iterator, Sequence

import numpy as np

from calib.rounding import SMALLEST_SIGMA_DN
from calib.transfer.photon_transfer.curve_fit import Model
from calib.transfer.photon_transfer.estimates import NO_DARKS
from calib.transfer.photon_transfer.points import Curve
from calib.transfer.photon_transfer.recorded_cells import RecordedCells
from calib.transfer.photon_transfer.rounding_state import Rounding
from calib.transfer.photon_transfer.tap_transfer import TapTransfer

_SEEN_SIGMA = 5.0
_MANY_REJECTED = 1e-3


def remarks(taps: Sequence[TapTransfer], curve: Curve, recorded: RecordedCells) -> tuple[str, ...]:
    """Return them, the gravest first."""
    return (
        *_of_recording(curve, recorded),
        *_of_lines(recorded),
        *(text for tap in taps for text in _of_tap(tap)),
    )


def _of_recording(curve: Curve, recorded: RecordedCells) -> Iterator[str]:
    if not curve.dark.is_known:
        yield f"The signal is counted from code 0 ({NO_DARKS}): record darks."
    if not recorded.common_removed:
        yield (
            f"Made from {recorded.source}: what all pixels of a line or frame share (lamp, line "
            "noise) is in the variances."
        )
    rejected = max((b.rejected_share for b in recorded.blocks), default=0.0)
    if rejected > _MANY_REJECTED:
        yield f"Up to {100 * rejected:.2g} % of a block's differences are outliers, and left out."
    if curve.defects:
        yield (
            f"{curve.defects} of {len(recorded.tap)} cells have another variance than their like, "
            "and are left out."
        )


def _of_lines(recorded: RecordedCells) -> Iterator[str]:
    """Warn where a line correlates with the next: differences then miss a part of the noise.

    The ratio is of sums over a block's columns: one column's covariance goes against the error of
    its own variance, and the mean of such ratios is off by 1/n, n lines.
    """
    found, weight = 0.0, 0.0
    for block in recorded.blocks:
        covariance, variance = block.line_covariance_dn2, block.variance_dn2
        known = np.isfinite(covariance) & np.isfinite(variance)
        if block.n_exposures > 2 and known.any():
            total = float(variance[known].sum())
            share = block.n_exposures * total**2 / (2.0 * float((variance[known] ** 2).sum()))
            found += share * float(covariance[known].sum()) / total
            weight += share
    if weight and abs(found) > _SEEN_SIGMA * np.sqrt(weight):
        yield (
            f"A line's noise correlates with the next one's by {found / weight:+.4f} "
            f"({abs(found) / np.sqrt(weight):.0f} standard errors), as a lag makes it: variances, "
            "and with them the system gain, are off by about that share."
        )


def _of_tap(tap: TapTransfer) -> Iterator[str]:
    name = f"Tap {tap.tap}"
    by_charge = (Model.BRIGHTER_FATTER, Model.NONLINEAR_AND_BRIGHTER_FATTER)
    near = [n for n in tap.neighbours if max(n.lag) == 1]
    if near and tap.choice.called_for not in by_charge:
        sides = np.array([2.0 if 0 in n.lag else 4.0 for n in near])
        total = float(sides @ np.array([n.correlation for n in near]))
        error = float(np.sqrt(sides**2 @ np.array([n.correlation_std for n in near]) ** 2))
        if abs(total) > _SEEN_SIGMA * error:
            yield (
                f"{name}: neighbours' noise correlates, by {total:+.4f} ± {error:.4f} summed over "
                "the nearest: charge or voltage that is shared takes that share from the variance, "
                "and from the system gain with it."
            )
    if tap.has_darks:
        yield from _of_rounding(name, tap)
    if not tap.choice.fits.tell_of_a_bend:
        yield f"{name}: {tap.choice.why}."


def _of_rounding(name: str, tap: TapTransfer) -> Iterator[str]:
    """Say where rounding limits the read noise."""
    if tap.rounding is Rounding.HIDDEN:
        yield (
            f"{name}: the noise in the dark is below {SMALLEST_SIGMA_DN} DN: rounding to whole "
            "codes hides it, and the read noise is not determined. A higher gain of the camera "
            "would lift it."
        )
    elif tap.rounding is Rounding.ON_AVERAGE:
        noise = float(np.sqrt(tap.gain_and_read[1]))
        yield (
            f"{name}: the noise in the dark is {noise:.2f} DN: rounding is undone on average "
            "over pixels, not one by one, and what that leaves is in the errors of read noise and "
            "system gain; more lines (frames) do not lessen it."
        )
