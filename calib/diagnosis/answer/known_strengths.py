"""How strong the brighter-fatter effect is where it was measured: a yardstick, and no bound.

Source: C. Lage's covariances of flat pairs of LSST's CCDs (Poisson_CCD, measurements/
e2v_covariances_21oct19.txt and itl_covariances_21oct19.txt), Cov / mean^2 per electron. These are
two thick, fully depleted CCDs of 10 um pixels; another sensor's may be several times as large or
as small, so that no fit is held within them. Caution: the files' covariances of all lags, their own
variance's included, sum to 0 to 0.1 %, as if that had been imposed: the variance's is no
measurement of its own, and only neighbours are used here.
"""

from collections.abc import Iterable

from calib.forward.departure import Departure
from calib.forward.effects.brighter_fatter import BrighterFatter

LSST_PER_E = {
    "row_per_e": (7.245e-8, 9.828e-8),
    "column_per_e": (1.761e-7, 2.747e-7),
    "corner_per_e": (4.347e-8, 6.433e-8),
}
"""Smaller and larger of the two sensors', by the effect's parameter."""
IMPLAUSIBLE = 5.0
"""Times the larger: pixels of a quarter of the area and half the depth do not make more."""


def remarks(effects: Iterable[Departure]) -> tuple[str, ...]:
    """Return a sentence where a brighter-fatter effect is far stronger than any that is known."""
    found = []
    for effect in effects:
        if not isinstance(effect, BrighterFatter):
            continue
        ratio, name = max(
            (float(getattr(effect, n)) / most, n) for n, (_, most) in LSST_PER_E.items()
        )
        if ratio > IMPLAUSIBLE:
            found.append(
                f"brighter_fatter is fitted with {name} = {getattr(effect, name):.2g} 1/e-, "
                f"{ratio:.0f} times that of LSST's CCDs: charge hardly repels so much; light that "
                "spreads, pixels that were averaged or capacitance are likelier."
            )
    return tuple(found)
