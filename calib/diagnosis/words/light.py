"""One sentence for every effect of the light: of lamps, what strays, and exposures."""

from math import log

from calib.diagnosis.words.telling import Sentence, Telling


def _reciprocity(t: Telling) -> str:
    span = log(max(t.scales.most_radiance / t.scales.least_radiance, 2.0))
    return (
        f"Faint light is answered {t.scaled_share('exponent', span)} "
        f"{t.either('exponent', 'less', 'more')} than the brightest in proportion: "
        "reciprocity failure."
    )


def _jitters(t: Telling) -> str:
    of = f" of {t.value('reference_us'):g} us, however long they are,"
    return of if getattr(t.effect, "constant") == "time" else ""  # noqa: B009 - its own


def _stray(t: Telling) -> str:
    return (
        "Light from elsewhere reaches the uncapped lens, "
        f"{t.scaled_share('radiance', 1.0 / t.scales.most_radiance)} of the brightest level: "
        "stray light."
    )


LIGHT: dict[str, Sentence] = {
    "lamp_drift": lambda t: (
        f"The lamp {t.either('amplitude', 'brightened', 'faded')} by "
        f"{t.scaled_share('amplitude', t.settled)} while the recording was made: lamp drift."
    ),
    "lamp_flicker": lambda t: (
        f"The light swings by ± {t.share('amplitude')} at "
        f"{t.scaled('mains_hz', 2.0, 'Hz')}: lamp flicker."
    ),
    "level_nonadditivity": lambda t: (
        f"Each further lamp {t.either('loss_per_lamp', 'takes', 'adds')} "
        f"{t.share('loss_per_lamp')} of the light of all: lamps do not add up."
    ),
    "stray_light": _stray,
    "exposure_offset": lambda t: (
        f"Each exposure is {t.size('offset_us', 'us')} "
        f"{t.either('offset_us', 'longer', 'shorter')} than stated: an exposure offset."
    ),
    "exposure_jitter": lambda t: (
        f"Exposures scatter by {t.share('relative_std')}{_jitters(t)} from line to line: exposure "
        "jitter."
    ),
    "reciprocity_failure": _reciprocity,
}  # fmt: skip
"""By the effect's name."""
