"""What all pixels of a frame do together: an offset of the frame, a flicker of the light.

With a frame's offset noise a (DN²) and the light's relative variance φ, a pixel of signal q has
a + φq² in its variance beside its own noise, and so has, at the mean signal, the mean of a frame:

    x = var(frame mean) − Σᵢ vᵢ/N² = a + φq̄².

a cancels in V = σ₂² − σ₁², φ does not: 0.1 % of flicker on 10⁴ DN of 1 DN/e⁻ raises G by 3 %. x at
two exposures tells which share of it is flicker, and pixel by pixel it is taken off. Where the
light is even, that is the same as to subtract each frame's mean deviation: what the frames share
is gone, its own scatter with it. Where it is not, the share's uncertainty stays, and flicker that
the frame means do not show is not taken off: a spot's flicker is faint in the mean of a dark frame.
"""

from dataclasses import dataclass

import numpy as np

from calib.transfer.two_exposures.frame_series import FrameSeries

SEEN_SIGMA = 3.0
"""From here on a rise of x with the signal is flicker."""


@dataclass(frozen=True)
class CommonMode:
    """Common to the pixels of a frame, at both exposures.

    Attributes:
        excess_dn2: x of the first and of the second exposure; may be negative by chance.
        excess_std_dn2: Their standard errors.
        own_std_dn2: The part of them that the pixels' own noise makes.
        mean_signal_dn: q̄ of the first exposure.
        ratio: r.
    """

    excess_dn2: tuple[float, float]
    excess_std_dn2: tuple[float, float]
    own_std_dn2: tuple[float, float]
    mean_signal_dn: float
    ratio: float

    @classmethod
    def of(
        cls,
        first: FrameSeries,
        second: FrameSeries,
        mean_variances_dn2: tuple[float, float],
        mean_signal_dn: float,
        ratio: float,
    ) -> "CommonMode":
        """Return it from frame means and the mean of the same pixels' variances."""
        excess, std, own = [], [], []
        for series, variance in zip((first, second), mean_variances_dn2, strict=True):
            share = variance / series.n_pixels
            # vᵢ holds x, too: without 1 − 1/N a share of it would stay in the variances.
            beyond = (series.variance_of_frame_mean_dn2 - share) / (1.0 - 1.0 / series.n_pixels)
            excess.append(beyond)
            scatter = float(np.sqrt(2.0 / series.n_free))
            std.append(scatter * series.variance_of_frame_mean_dn2)
            own.append(scatter * share)
        return cls(
            (excess[0], excess[1]), (std[0], std[1]), (own[0], own[1]), mean_signal_dn, ratio
        )

    @property
    def flicker_relative2(self) -> float:
        """φ, relative; 0 where there is no light to flicker."""
        return (self.excess_dn2[1] - self.excess_dn2[0]) / self._lever if self._lever > 0 else 0.0

    @property
    def offset_dn2(self) -> float:
        """a, DN²."""
        return self.excess_dn2[0] - self.flicker_relative2 * self.mean_signal_dn**2

    def in_variance(self, exposure: int) -> tuple[float, float]:
        """Return a and b, a + bq² being in the variance of pixels of that q (of t), DN²."""
        excess, share = self.excess_dn2[exposure], self._flicker_share(exposure)
        if share == 0.0:
            return excess, 0.0
        return excess * (1.0 - share), excess * share / self.mean_signal_dn**2

    def variance_std(self, exposure: int, mean_square_dn2: float) -> float:
        """Return the uncertainty of what is taken off the mean variance of pixels of that q², DN².

        The pixels' own noise in x, and of the scatter of both x what makes the share uncertain.
        """
        share = self._flicker_share(exposure)
        if share == 0.0:
            return self.own_std_dn2[exposure]
        uneven = mean_square_dn2 / self.mean_signal_dn**2 - 1.0
        own = self.own_std_dn2[exposure] * (1.0 + share * uneven)
        of_share = float(np.hypot(*self.excess_std_dn2)) * self._scale(exposure) * uneven
        return float(np.hypot(own, of_share / (self.ratio**2 - 1.0)))

    def in_mean(self, exposure: int, signal_dn: float, other_dn: float) -> float:
        """Return the covariance of two means over a frame, of those q, DN²; where even, x."""
        share = self._flicker_share(exposure)
        uneven = signal_dn * other_dn / self.mean_signal_dn**2 if share else 1.0
        return self.excess_dn2[exposure] * (1.0 - share + share * uneven)

    def _flicker_share(self, exposure: int) -> float:
        """Return φq̄² over x, 0 … 1; 0 where flicker is not seen beyond the pixels' own noise."""
        rise = self.excess_dn2[1] - self.excess_dn2[0]
        excess = self.excess_dn2[exposure]
        if not self._lever > 0 or rise < SEEN_SIGMA * np.hypot(*self.own_std_dn2) or excess <= 0:
            return 0.0
        flicker = self.flicker_relative2 * self._scale(exposure) * self.mean_signal_dn**2
        return float(min(flicker / excess, 1.0))

    def _scale(self, exposure: int) -> float:
        return self.ratio**2 if exposure else 1.0

    @property
    def _lever(self) -> float:
        signal = max(self.mean_signal_dn, 0.0)
        return (self.ratio**2 - 1.0) * signal**2
