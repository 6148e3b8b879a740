"""A window between the scene and the camera, which was not there during calibration.

Source: Olsen et al. 2010 (AgCam), section 2: the science window of the Destiny laboratory.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from calib.errors import InputError


@dataclass(frozen=True)
class Window:
    """A plane window of one transmittance over the whole field, as seen in the camera's band.

    What the camera sees behind the window is T·L. `apply` therefore divides by T, and the radiance
    that it returns is that in front of the window. Light that the window itself scatters, reflects
    or emits is not taken into account. Where a source is seen through the window during the
    calibration too, either leave the window out in both (it is then part of the responsivity), or
    multiply the source's radiance by T: see `behind`.

    Attributes:
        transmittance: T, band-effective, 0 < T <= 1.
        std: Its standard uncertainty (k = 1); an error that all columns and lines share.
        name: What it is, for the output's metadata.
    """

    transmittance: float
    std: float
    name: str = "window"

    def __post_init__(self) -> None:
        if not 0 < self.transmittance <= 1:
            msg = f"A window's transmittance is {self.transmittance}: give above 0, at most 1."
            raise InputError(msg, code="transmittance-out-of-range")
        if not 0 <= self.std < self.transmittance:
            msg = (
                f"The standard uncertainty {self.std} of a window's transmittance must be given "
                "and lie between 0 and the transmittance itself."
            )
            raise InputError(msg, code="transmittance-out-of-range")

    @property
    def relative_std(self) -> float:
        """Relative standard uncertainty, which adds in quadrature to the radiance scale's."""
        return self.std / self.transmittance

    def behind(self, radiance: float, std: float = 0.0) -> tuple[float, float]:
        """Return the radiance behind the window and its standard uncertainty."""
        value = radiance * self.transmittance
        return value, float((self.transmittance**2 * std**2 + radiance**2 * self.std**2) ** 0.5)


DESTINY_RED = Window(0.980, 0.0005 / 3**0.5, "Destiny science window, red (AgCam 2010)")
"""The paper's 98.0 %. It states no uncertainty: that of the last digit's rounding stands in for it,
a lower bound; give your own where you have one."""

DESTINY_NIR = Window(0.934, 0.0005 / 3**0.5, "Destiny science window, NIR (AgCam 2010)")
"""The paper's 93.4 %, with the same lower bound."""

WINDOWS: Final[Mapping[str, Window]] = {"destiny-red": DESTINY_RED, "destiny-nir": DESTINY_NIR}
"""Those that `darkflat apply --window` knows by name."""
