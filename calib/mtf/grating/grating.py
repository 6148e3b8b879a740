"""A grating: which harmonics its orders make.

The image is the squared modulus of the orders' sum, so that its harmonics are the orders'
differences: c(d) = Σ a_j·conj(a_k) over all pairs with p_j − p_k = d. (Section 1 of the 2018
paper, Fig. 1.)
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.mtf.grating.harmonics import Harmonics
from calib.mtf.grating.orders import Indices, circle_orders
from calib.mtf.grating.source import Source

_NEGLIGIBLE = 1e-12


@dataclass(frozen=True)
class UnwantedOrder:
    """A weak order where none should be.

    Attributes:
        p: Its index along x.
        q: Its index along y.
        amplitude: Of its field, relative to a wanted order's; complex.
    """

    p: int
    q: int
    amplitude: complex


@dataclass(frozen=True)
class Grating:
    """A continuously self-imaging grating, its wanted orders of equal amplitude and in phase.

    Attributes:
        eta2: η²: the squared radius of the circle of orders, in units of (1/a0)².
        period_um: a0, µm.
        unwanted: Weak orders beside the wanted ones.
        source: None for a plane monochromatic wave right behind the grating.
    """

    eta2: int
    period_um: float
    unwanted: tuple[UnwantedOrder, ...] = ()
    source: Source | None = None

    def __post_init__(self) -> None:
        circle_orders(self.eta2)
        if not (np.isfinite(self.period_um) and self.period_um > 0):
            msg = f"a grating's period of {self.period_um} µm cannot be: give one above 0"
            raise InputError(msg, code="bad-grating")

    @property
    def n_orders(self) -> int:
        """How many wanted orders there are."""
        return len(circle_orders(self.eta2))

    @property
    def max_frequency_per_um(self) -> float:
        """Fmax = 2η/a0, the pattern's highest frequency, cycles per µm."""
        return float(2 * np.sqrt(self.eta2) / self.period_um)

    @cached_property
    def harmonics(self) -> Harmonics:
        """Return its harmonics, unwanted orders' included."""
        orders, fields = self._fields()
        difference = (orders[:, None] - orders[None]).reshape(-1, 2)
        product = np.multiply.outer(fields, fields.conj())
        if self.source is not None:
            squared = (orders**2).sum(1)
            product = product * self.source.coherence(
                np.subtract.outer(squared, squared), self.period_um
            )
        index, where = np.unique(difference, axis=0, return_inverse=True)
        power = np.zeros(len(index), np.complex128)
        np.add.at(power, where.ravel(), product.ravel())
        mean = power[(index == 0).all(1)].real
        half = (index[:, 0] > 0) | ((index[:, 0] == 0) & (index[:, 1] > 0))
        half &= np.abs(power) > _NEGLIGIBLE * mean
        order = np.argsort((index[half] ** 2).sum(1), kind="stable")
        return Harmonics(index[half][order], power[half][order] / mean, self.period_um)

    def _fields(self) -> tuple[Indices, NDArray[np.complex128]]:
        """Return every order's indices and amplitude."""
        wanted = circle_orders(self.eta2)
        extra = np.array([(each.p, each.q) for each in self.unwanted], np.int64).reshape(-1, 2)
        weak = np.array([each.amplitude for each in self.unwanted], np.complex128)
        return np.vstack([wanted, extra]), np.concatenate([np.ones(len(wanted)), weak])
