"""One sentence for every effect of the charge: what gathers, is lost, or stays behind."""

from calib.diagnosis.words.telling import Sentence, Telling


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
    most = t.most_transfers(t.word("readout"), t.word("tap_layout"))
    return (
        f"Each transfer to the output leaves {t.scaled('per_transfer', 1e6, '')} millionths of a "
        f"charge of {t.value('reference_e'):.0f} electrons behind, "
        f"{t.scaled_share('per_transfer', most)} over the whole register: "
        "charge transfer inefficiency."
    )


CHARGE: dict[str, Sentence] = {
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
}  # fmt: skip
"""By the effect's name."""
