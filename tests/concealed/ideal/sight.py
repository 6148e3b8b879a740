"""How clearly the best filter sees what is hidden: it knows the effect and all nominal figures.

The square of the answer, in standard deviations, is the deviance between the recording's
distribution with the effect and the nearest without it, twice the Kullback-Leibler distance, in
parts that are added: means (offset and responsivity of each pixel free), variances (system
gain and read noise free), correlations of neighbours, distributions of codes, single events. Parts
that an effect has not are 0. Of events that chance makes, those are counted that it made in this
recording: where a line was to be sent twice once on average and never was, there is nothing to see.
"""

from math import sqrt

from tests.concealed.generator.answer import happened_in
from tests.concealed.generator.case import Case
from tests.concealed.generator.mechanism import Mechanism, Stage
from tests.concealed.generator.scan import Happened
from tests.concealed.generator.setting import Setting
from tests.concealed.ideal.correlations import correlation_deviance
from tests.concealed.ideal.distributions import distribution_deviance
from tests.concealed.ideal.events import EVENTS, event_deviance
from tests.concealed.ideal.expected import expected
from tests.concealed.ideal.means import excess_of, mean_deviance, variance_deviance
from tests.concealed.ideal.scatter import scatter_deviance

NO_SHIFT = {"cosmic_rays", "brighter_fatter", "rts_pixels", "heavy_tailed_noise"}
LINEAR_COUPLING = {"interpixel_capacitance", "tap_crosstalk"}


def sight(case: Case) -> tuple[float, ...]:
    """Return the standard deviations at which each hidden effect of `case` is seen, alone."""
    by_chance = any(one.name in EVENTS for one in case.mechanisms)
    happened = happened_in(case) if by_chance else {}
    return tuple(_sight_of(one, case.setting, happened) for one in case.mechanisms)


def _sight_of(one: Mechanism, setting: Setting, happened: Happened) -> float:
    plain = list(expected(setting, ()))
    deviance = correlation_deviance(one, plain) + scatter_deviance(one, plain)
    deviance += distribution_deviance(one, plain, happened)
    deviance += event_deviance(one, plain, happened)
    if one.stage < Stage.QUANTISATION and one.name not in NO_SHIFT:
        hidden = list(expected(setting, (one,)))
        deviance += mean_deviance(plain, hidden)
        if one.name not in LINEAR_COUPLING:
            deviance += variance_deviance(plain, excess_of(plain, hidden))
    return sqrt(deviance)
