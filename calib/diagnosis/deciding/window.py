"""A window of the sensor, and what effects tell pixel by pixel as it is there."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.deciding.rivals import Rivals
from calib.diagnosis.naming.model import Member
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.simulation.with_values import with_values
from calib.forward.parameter import parameters_of

PIXELS, RATES = "pixels", "rates_e_per_us"
"""Parameters that tell pixel by pixel: which, and the rates of these, or else of all."""


@dataclass(frozen=True)
class Window:
    """Some rows and columns of a sensor.

    Attributes:
        sensor: The whole: rows and columns.
        at: The window: the first rows, and the columns.
    """

    sensor: tuple[int, int]
    at: tuple[slice, slice]

    @property
    def pixels(self) -> NDArray[np.intp]:
        """Which of the sensor's pixels it holds, row by row, (n_window_pixels,)."""
        numbers = np.arange(np.prod(self.sensor), dtype=np.intp)
        return numbers.reshape(self.sensor)[self.at].ravel()

    def of(self, rivals: Rivals) -> Rivals:
        """Return the effects as they are in the window."""
        return Rivals(tuple(map(self._of, rivals.members)), tuple(map(self._of, rivals.others)))

    def _of(self, member: Member) -> Member:
        shape = self.shape(member.signature.shape)
        return replace(member, signature=replace(member.signature, shape=shape))

    def shape(self, shape: Shape) -> Shape:
        """Return the shape in the window.

        Where pixels are told one by one, their rates are such that the mean of the squares over all
        pixels stays what it is: separations on the window times the factor that the rest of the
        sensor is worth are then what the told pixels give, wherever they lie.
        """
        template = shape.template
        if not getattr(template, RATES, ()):
            return shape
        told: dict[str, tuple[float, ...]] = {}
        rates = np.asarray(getattr(template, RATES))
        if PIXELS in parameters_of(type(template)):
            told[PIXELS], rates = self._told(np.asarray(getattr(template, PIXELS)), rates)
        else:
            rates = rates[self.pixels]
        told[RATES] = tuple(rates.tolist())
        varied = tuple((name, told.get(name, unit), low) for name, unit, low in shape.varied)
        return replace(shape, template=with_values(template, told), varied=varied)

    def _told(
        self, pixels: NDArray[np.intp], rates: NDArray[np.float64]
    ) -> tuple[tuple[int, ...], NDArray[np.float64]]:
        """Return which pixels of the window are told, and their rates; one at least."""
        place = {int(pixel): k for k, pixel in enumerate(self.pixels)}
        inside = np.array([int(pixel) in place for pixel in pixels])
        found = tuple(place[int(pixel)] for pixel in pixels[inside])
        if not found:  # The fastest stands for all, in the middle.
            inside, found = np.arange(len(rates)) == np.argmax(rates), (len(place) // 2,)
        share = len(place) / np.prod(self.sensor)
        kept = rates[inside]
        return found, kept * np.sqrt(share * (rates**2).sum() / (kept**2).sum())
