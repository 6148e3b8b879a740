"""The spatial frequencies of a pattern, and the lattice of shifts that leave it as it is."""

from dataclasses import dataclass
from functools import cached_property
from math import gcd

import numpy as np
from numpy.typing import NDArray

from calib.mtf.grating.orders import Indices


@dataclass(frozen=True, eq=False)
class Harmonics:
    """One of each pair ±f of a real pattern, by rising |f|; the mean is not among them.

    The pattern is 1 + 2·Re Σ amplitude·exp(2πi f·x): its mean is 1.

    Attributes:
        index: Differences of orders (p, q), (n, 2), in the half plane p > 0 or p = 0 < q.
        amplitude: Relative to the mean, (n,).
        period_um: a0, µm.
    """

    index: Indices
    amplitude: NDArray[np.complex128]
    period_um: float

    def __len__(self) -> int:
        return len(self.index)

    @cached_property
    def frequency_per_um(self) -> NDArray[np.floating]:
        """Spatial frequencies (fx, fy) in the grating's frame, cycles per µm: (n, 2)."""
        return self.index / self.period_um

    @property
    def count(self) -> int:
        """How many there are with both of each pair, as the paper counts them."""
        return 2 * len(self.index)

    @cached_property
    def lattice_um(self) -> NDArray[np.floating]:
        """Two shifts that leave the pattern as it is and generate all others: rows, µm."""
        dual: NDArray[np.floating] = self.period_um * np.linalg.inv(self._generators).T
        return dual

    def shortest(self, shift_um: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the shift nearest to zero that moves the pattern as `shift_um` does: (2,)."""
        basis = self.lattice_um
        turns = self._generators @ shift_um / self.period_um
        rest = (turns - np.round(turns)) @ basis
        steps = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]) @ basis
        candidates: NDArray[np.floating] = rest + steps
        return np.asarray(candidates[np.argmin(np.hypot(*candidates.T).round(9))])

    @cached_property
    def _generators(self) -> Indices:
        """Two integer vectors that generate the same lattice as all indices: rows."""
        first, second = (0, 0), 0
        for p, q in self.index.tolist():
            first, rest = _reduced(first, (p, q))
            second = gcd(second, rest)
        if second:
            first = (first[0], first[1] % second)
        return np.array([first, (0, second)], np.int64)


def _reduced(one: tuple[int, int], two: tuple[int, int]) -> tuple[tuple[int, int], int]:
    """Euclid on the first numbers: the vector that is left, and the second's second number."""
    while two[0]:
        turns = one[0] // two[0]
        one, two = two, (one[0] - turns * two[0], one[1] - turns * two[1])
    return one, two[1]
