"""One sentence for every effect of the catalogue: what happens, how much of it, its name."""

from collections.abc import Callable
from math import log

from calib.diagnosis.words.telling import Telling

Sentence = Callable[[Telling], str]


def sentence_of(told: Telling) -> str:
    """Return what an operator is told of an effect: what happens, how much of it, its name."""
    return SENTENCES[told.effect.name](told)


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


def _dark(t: Telling) -> str:
    return (
        f"Charge gathers without light, {t.size('electrons_per_us', 'e-/us')} or "
        f"{t.scaled('electrons_per_us', t.scales.longest_us * t.scales.gain_dn_per_e, 'DN')} in "
        "the longest exposure: dark current."
    )


def _warm_dark(t: Telling) -> str:
    return (
        "Charge gathers without light and follows the sensor's temperature, "
        f"{t.size('electrons_per_us', 'e-/us')} at {t.value('reference_c'):g} °C, double every "
        f"{t.size('doubling_k', 'K')}: dark current of a sensor that warms up."
    )


def _brighter_fatter(t: Telling) -> str:
    # A pixel of a line has two neighbours: C = a mu^2 each, a variance of mu - 2 a mu^2.
    row, all_around = t.value("row_per_e"), 2.0 * t.value("row_per_e")
    if t.scales.rows > 1:
        all_around += 2.0 * t.value("column_per_e") + 4.0 * t.value("corner_per_e")
    lost = t.scaled_share("row_per_e", all_around / max(row, 1e-300) * t.scales.signal_e)
    return (
        "A pixel's charge pushes what comes next into its neighbours, which takes "
        f"{lost} of the noise's variance at the largest signal: brighter-fatter."
    )


def _cti(t: Telling) -> str:
    return (
        f"Each transfer to the output leaves {t.scaled('per_transfer', 1e6, '')} millionths of a "
        f"charge of {t.value('reference_e'):.0f} electrons behind, "
        f"{t.scaled_share('per_transfer', t.scales.columns)} over the whole register: "
        "charge transfer inefficiency."
    )


def _inl(t: Telling) -> str:
    return (
        f"The converter's codes lie up to {t.largest_inl_dn:.2g} DN off a straight line: "
        "integral nonlinearity."
    )


def _dnl(t: Telling) -> str:
    return (
        f"Codes are unequally wide, by {t.size('width_std_dn', 'DN')} (standard deviation): "
        "differential nonlinearity."
    )


def _bit(t: Telling) -> str:
    return (
        f"Bit {t.value('bit'):.0f} of the code sticks at {t.value('value'):.0f} in "
        f"{t.share('probability')} of the samples: a stuck bit."
    )


def _tap_drift(t: Telling) -> str:
    return (
        f"One tap's gain {t.either('amplitude', 'rose', 'fell')} by "
        f"{t.scaled_share('amplitude', t.settled)} against the others: a drift of a tap's gain."
    )


_SHARED_BY = {"row": "columns of a line move", "frame": "pixels of a frame move"}

SENTENCES: dict[str, Sentence] = {
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
    "dark_current": _dark,
    "dark_current_temperature": _warm_dark,
    "hot_pixels": lambda t: (
        f"{t.share('share')} of the pixels gather {t.size('electrons_per_us', 'e-/us')} more than "
        "the others without light: hot pixels."
    ),
    "amplifier_glow": lambda t: (
        "An amplifier glows beside the sensor, "
        f"{t.size('electrons_per_us', 'e-/us')} at its {getattr(t.effect, 'end', 'near')} end, a "
        f"third of it {t.size('decay_columns', 'column')} farther on: amplifier glow."
    ),
    "brighter_fatter": _brighter_fatter,
    "cosmic_rays": lambda t: (
        f"Particles leave {t.size('electrons', 'e-')} in a pixel at a time, "
        f"{t.scaled('per_pixel_s', 1e6, '')} times a second in a million pixels: cosmic rays."
    ),
    "saturation_knee": lambda t: (
        f"Above {t.size('threshold_e', 'e-')} a pixel keeps ever less of its charge: the response "
        "bends before it saturates."
    ),
    "lag": lambda t: (
        f"{t.share('share')} of a line's charge stays in the pixels and is read with the next "
        "line: lag."
    ),
    "persistence": lambda t: (
        f"{t.share('share')} of the charge is caught and leaks into later lines and blocks, to a "
        f"third within {t.size('time_constant_s', 's')}: persistence."
    ),
    "cti": _cti,
    "interpixel_capacitance": lambda t: (
        f"Neighbouring columns share {t.share('column_coupling')} of each other's signal after "
        "collection: interpixel capacitance."
    ),
    "heavy_tailed_noise": lambda t: (
        f"{t.share('share')} of all readings scatter by {t.size('std_e', 'e-')}, far more than the "
        "rest: heavy-tailed noise."
    ),
    "tap_gain_drift": _tap_drift,
    "gain_drift": lambda t: (
        f"The system gain {t.either('amplitude', 'rose', 'fell')} by "
        f"{t.scaled_share('amplitude', t.settled)} while the recording was made: gain drift."
    ),
    "nonlinearity": lambda t: (
        f"The largest signal is read {t.scaled_share('beta_per_dn', t.scales.signal_dn)} too "
        f"{t.either('beta_per_dn', 'low', 'high')}, smaller ones less so: nonlinearity."
    ),
    "tap_crosstalk": lambda t: (
        f"Each tap {t.either('fraction', 'adds', 'takes off')} {t.share('fraction')} of what its "
        "partner reads at the same time: tap crosstalk."
    ),
    "line_noise": lambda t: (
        f"All {_SHARED_BY[getattr(t.effect, 'shared_by')]} together, by "  # noqa: B009 - its own
        f"{t.size('std_dn', 'DN')} from one to the next: line noise."
    ),
    "banding": lambda t: (
        f"A tone of {t.size('amplitude_dn', 'DN')} at {t.size('frequency_hz', 'Hz')} runs through "
        "the lines: banding."
    ),
    "rts_pixels": lambda t: (
        f"{t.share('share')} of the pixels jump by {t.size('amplitude_dn', 'DN')} to and fro: "
        "random telegraph signal."
    ),
    "offset_drift": lambda t: (
        f"The offset {t.either('amplitude_dn', 'rose', 'fell')} by "
        f"{t.scaled('amplitude_dn', t.settled, 'DN')} while the recording was made: offset drift."
    ),
    "offset_temperature": lambda t: (
        f"The offset {t.either('dn_per_k', 'rises', 'falls')} by {t.size('dn_per_k', 'DN')} per "
        "kelvin of the sensor: it follows the temperature."
    ),
    "adc_inl": _inl,
    "adc_dnl": _dnl,
    "stuck_bit": _bit,
    "black_clip": lambda t: (
        f"No code lies below {t.value('level_dn'):.0f}: the camera clips at black."
    ),
    "duplicated_lines": lambda t: (
        f"{t.share('probability')} of the lines are the line before once more: duplicated lines."
    ),
}  # fmt: skip
"""By the effect's name."""
