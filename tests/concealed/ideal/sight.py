"""How clearly the best filter sees what is hidden: it knows the effect and all nominal figures.

The square of the answer, in standard deviations, is the deviance between the recording's
distribution with the effect and the nearest without it, twice the Kullback-Leibler distance, in
four parts that are added: means (offset and responsivity of each pixel free), variances (system
gain and read noise free), correlations of neighbours, distributions of codes. Parts that an effect
has not are 0.
"""

from math import sqrt

from tests.concealed.generator.case import Case
from tests.concealed.generator.mechanism import Mechanism, Stage
from tests.concealed.generator.setting import Setting
from tests.concealed.ideal.correlations import correlation_deviance
from tests.concealed.ideal.distributions import distribution_deviance
from tests.concealed.ideal.expected import expected
from tests.concealed.ideal.means import excess_of, mean_deviance, variance_deviance
from tests.concealed.ideal.scatter import scatter_deviance

NO_SHIFT = {"cosmic_rays", "brighter_fatter", "rts_pixels", "heavy_tailed_noise"}
LINEAR_COUPLING = {"interpixel_capacitance", "tap_crosstalk"}
_NATS_PER_PIXEL = 1.5
"""Of a line that equals the one before, about ln(2 sigma sqrt(pi)) with a sigma of 1 to 2 DN."""


def sight(case: Case) -> tuple[float, ...]:
    """Return the standard deviations at which each hidden effect of `case` is seen, alone."""
    return tuple(sight_of(one, case.setting) for one in case.mechanisms)


def sight_of(one: Mechanism, setting: Setting) -> float:
    """Return the same of one mechanism."""
    if one.name == "duplicated_lines":
        half = 0.5 if one.shape == "half" else 1.0
        pixels = half * setting.sensor.rows * setting.sensor.columns
        return sqrt(2 * _NATS_PER_PIXEL * pixels * one.strength * setting.n_lines)
    plain = list(expected(setting, ()))
    deviance = correlation_deviance(one, plain) + scatter_deviance(one, plain)
    deviance += distribution_deviance(one, plain)
    if one.stage < Stage.QUANTISATION and one.name not in NO_SHIFT:
        hidden = list(expected(setting, (one,)))
        deviance += mean_deviance(plain, hidden)
        if one.name not in LINEAR_COUPLING:
            deviance += variance_deviance(plain, excess_of(plain, hidden))
    return sqrt(deviance)
