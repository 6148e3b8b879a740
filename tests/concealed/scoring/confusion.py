"""Which name was given for which effect."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tests.concealed.generator.catalogue import LISTED, UNLISTED
from tests.concealed.scoring.outcome import Outcome

OTHER = ("unexplained", "none")


def confusion(
    outcomes: Sequence[Outcome],
) -> tuple[tuple[str, ...], tuple[str, ...], NDArray[np.intp]]:
    """Return hidden names, given names, and counts (hidden, given) over cases of one effect."""
    hidden, given = (*LISTED, *UNLISTED), (*LISTED, *OTHER)
    counts = np.zeros((len(hidden), len(given)), dtype=np.intp)
    for one in outcomes:
        if len(one.truths) == 1 and one.first in given:
            counts[hidden.index(one.truths[0].name), given.index(one.first)] += 1
    return hidden, given, counts
