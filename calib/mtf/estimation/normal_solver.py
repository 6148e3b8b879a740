"""Solves the normal equations, or says that the recording does not determine the unknowns."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, lapack

from calib.errors import NotDeterminedError
from calib.mtf.estimation.state import State, Unknowns

_LEAST_CONDITION = 1e-9


@dataclass(frozen=True, eq=False)
class NormalSolver:
    """A factorised normal matrix; steady frames' mean stage error and mean level do not move."""

    factor: NDArray[np.floating]
    scale: NDArray[np.floating]

    @classmethod
    def of(cls, normal: NDArray[np.floating], state: State) -> "NormalSolver":
        """Factorise.

        Raises:
            NotDeterminedError: `aliased` where two unknowns cannot be told apart.
        """
        if not np.diag(normal).min() > 0:
            raise _aliased()
        scale = 1 / np.sqrt(np.diag(normal))
        scaled = normal * np.multiply.outer(scale, scale)
        for which in range(3):
            at = state.layout.of_frames(which)
            direction = scale[at] * state.steady
            scaled[at, at] += np.multiply.outer(direction, direction) / (direction**2).mean()
        factor, failed = lapack.dpotrf(scaled, lower=1)
        condition = (
            0.0 if failed else lapack.dpocon(factor, np.abs(scaled).sum(0).max(), uplo="L")[0]
        )
        if condition < _LEAST_CONDITION:
            raise _aliased()
        return cls(factor, scale)

    def solve(self, right: NDArray[np.floating]) -> Unknowns:
        """Return the solution for one right-hand side, or for several as columns."""
        scale = self.scale if right.ndim == 1 else self.scale[:, None]
        solution: Unknowns = scale * cho_solve((self.factor, True), scale * right)
        return solution


def _aliased() -> NotDeterminedError:
    msg = (
        "these frames do not tell all of the pattern's harmonics apart, since some alias onto each"
    )
    msg += " other: record more stage positions, or a larger part of the detector"
    return NotDeterminedError(msg, code="aliased")
