"""One sentence for every effect of the readout: of noise, gain, offset, codes and lines."""

from calib.diagnosis.words.telling import Sentence, Telling
from calib.forward.code_fault import CodeFault

_WHEN = {False: "reads at the same time", True: "has read just before"}
_WHOSE = {False: "All", True: "Each tap's"}
_SHARED_BY = {"row": "columns of a line move", "frame": "pixels of a frame move"}


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
        f"{t.share('probability')} of the samples{_of_tap(t)}: a stuck bit."
    )


def _stop(t: Telling) -> str:
    level = f"{t.value('level_dn'):.0f}"
    if t.value("keeps") == 0.0:
        return f"No code{_of_tap(t)} lies below {level}: the camera clips at black."
    return (
        f"Codes{_of_tap(t)} below {level} keep {t.share('keeps')} of their distance from it: the "
        "camera clips softly at black."
    )


def _of_tap(t: Telling) -> str:
    tap = t.effect.only_tap if isinstance(t.effect, CodeFault) else None
    return "" if tap is None else f" of tap {tap}"


def _tap_drift(t: Telling) -> str:
    return (
        f"One tap's gain {t.either('amplitude', 'rose', 'fell')} by "
        f"{t.scaled_share('amplitude', t.settled)} against the others: a drift of a tap's gain."
    )


READOUT: dict[str, Sentence] = {
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
        f"partner {_WHEN[bool(t.value('pixels_before'))]}: tap crosstalk."
    ),
    "line_noise": lambda t: (
        f"{_WHOSE[bool(t.value('each_tap'))]} "
        f"{_SHARED_BY[t.word('shared_by')]} together, by "
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
    "black_clip": _stop,
    "duplicated_lines": lambda t: (
        f"{t.share('probability')} of the lines are the line before once more: duplicated lines."
    ),
}  # fmt: skip
"""By the effect's name."""
