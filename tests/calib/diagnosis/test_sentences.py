"""The sentences of all effects, their numbers worked out by hand from the effects' formulas."""

import math

import pytest

from calib.diagnosis.answer.estimate import Estimate
from calib.diagnosis.shapes.of_effects import departures
from calib.diagnosis.words.scales import RecordingScales
from calib.diagnosis.words.sentences import SENTENCES, sentence_of
from calib.diagnosis.words.telling import Telling
from calib.forward.departure import Departure
from calib.forward.effects.catalogue import effect_named
from calib.forward.parameter import parameters_of

SCALES = RecordingScales(
    duration_s=300.0, longest_us=1000.0, signal_dn=3000.0, signal_e=30_000.0, gain_dn_per_e=0.1,
    least_radiance=1.0, most_radiance=10.0, rows=1, columns=256, full_scale_dn=4095,
)  # fmt: skip
TEN_PERCENT = 0.1

# Settled drifts: 1 - exp(-300 / 100) = 0.950. ln 10 = 2.303. A tenth asks for two digits.
CASES: tuple[tuple[str, dict[str, object], str], ...] = (
    ("lamp_drift", {"amplitude": -0.02, "time_constant_s": 100.0}, "faded by 1.9 %"),
    ("lamp_flicker", {"amplitude": 0.005, "mains_hz": 50.0}, "± 0.50 % at 100 Hz"),
    ("level_nonadditivity", {"loss_per_lamp": 0.03}, "lamp takes 3.0 % of the light"),
    ("stray_light", {"radiance": 0.2}, "2.0 % of the brightest level"),
    ("exposure_offset", {"offset_us": -0.5}, "0.50 µs shorter"),
    ("exposure_jitter", {"relative_std": 0.002}, "scatter by 0.20 % from line to line"),
    (
        "exposure_jitter",
        {"relative_std": 0.002, "constant": "time"},
        "scatter by 0.20 % of 1000 us, however long they are",
    ),
    ("reciprocity_failure", {"exponent": 0.02}, "4.6 % less"),
    ("dark_current", {"electrons_per_us": 0.5}, "0.50 e⁻/µs or 50 DN in the longest"),
    ("dark_current_temperature", {"electrons_per_us": 0.5}, "0.50 e⁻/µs at 25 °C"),
    (
        "hot_pixels",
        {"share": 0.03, "electrons_per_us": 2.0},
        "3.0 % of the pixels gather 2.0",
    ),
    ("amplifier_glow", {"electrons_per_us": 0.05}, "0.050 e⁻/µs at its left end"),
    ("brighter_fatter", {"row_per_e": 1e-6}, "takes 6.0 % of the noise's variance"),
    ("cosmic_rays", {"per_pixel_s": 0.001}, "1000 times a second in a million pixels"),
    ("saturation_knee", {"threshold_e": 20_000.0}, "Above 20000 e⁻"),
    ("lag", {"share": 0.01}, "1.0 % of a line's charge stays"),
    ("persistence", {"share": 0.05, "time_constant_s": 5.0}, "5.0 % of the charge"),
    ("cti", {"per_transfer": 2e-5}, "20 millionths of a charge of 10000 electrons behind, 0.51 %"),
    ("cti", {"per_transfer": 2e-5, "tap_layout": "odd_even"}, "0.26 % over the whole register"),
    ("interpixel_capacitance", {"column_coupling": 0.012}, "columns share 1.2 % of each other's"),
    ("heavy_tailed_noise", {"share": 0.01, "std_e": 50.0}, "1.0 % of all readings"),
    ("tap_gain_drift", {"amplitude": (0.0, -0.02), "time_constant_s": 100.0}, "fell by 1.9 %"),
    ("gain_drift", {"amplitude": 0.02, "time_constant_s": 100.0}, "rose by 1.9 %"),
    ("nonlinearity", {"beta_per_dn": 2e-6}, "read 0.60 % too low"),
    ("tap_crosstalk", {"fraction": -0.005}, "takes off 0.50 %"),
    ("tap_crosstalk", {"pixels_before": 1}, "what its partner has read just before"),
    ("line_noise", {"std_dn": 0.5}, "All columns of a line move together, by 0.50 DN"),
    ("line_noise", {"shared_by": "frame"}, "All pixels of a frame move together"),
    ("line_noise", {"each_tap": True}, "Each tap's columns of a line move together"),
    ("banding", {"amplitude_dn": 3.0, "frequency_hz": 12345.0}, "A tone of 3.0 DN"),
    ("rts_pixels", {"amplitude_dn": 5.0, "share": 0.02}, "2.0 % of the pixels jump by 5.0 DN"),
    ("offset_drift", {"amplitude_dn": -2.0, "time_constant_s": 100.0}, "fell by 1.9 DN"),
    ("offset_temperature", {"dn_per_k": 0.2}, "rises by 0.20 DN per kelvin"),
    ("adc_inl", {"bow_dn": 2.0, "s_dn": 0.0, "w_dn": 0.0}, "up to 2 DN off a straight line"),
    ("adc_dnl", {"width_std_dn": 0.2}, "by 0.20 DN (standard deviation)"),
    ("stuck_bit", {"probability": 0.5, "bit": 3, "value": 0}, "Bit 3 of the code sticks at 0"),
    ("stuck_bit", {"only_tap": 1, "tap_layout": "halves"}, "of the samples of tap 1"),
    ("black_clip", {"level_dn": 60}, "No code lies below 60"),
    ("black_clip", {"only_tap": 0, "tap_layout": "halves"}, "No code of tap 0 lies below 60"),
    ("black_clip", {"keeps": 0.5}, "Codes below 60 keep 50 % of their distance"),
    ("duplicated_lines", {"probability": 0.05}, "5.0 % of the lines"),
)


def told(name: str, values: dict[str, object]) -> str:
    """Return the sentence of an effect whose parameters are known to a tenth."""
    kind = effect_named(name)
    assert issubclass(kind, Departure)
    units = {n: p.unit for n, p in parameters_of(kind).items()}
    estimates = {
        n: Estimate(v, TEN_PERCENT * abs(v), units[n])
        for n, v in values.items()
        if isinstance(v, float)
    }
    for n, v in values.items():
        if isinstance(v, tuple):
            estimates[n] = Estimate(max(v, key=abs), TEN_PERCENT * abs(max(v, key=abs)), units[n])
    return sentence_of(Telling(kind(**values), estimates, SCALES))


@pytest.mark.parametrize(("name", "values", "part"), CASES, ids=[c[0] for c in CASES])
def test_a_sentence_says_how_much(name: str, values: dict[str, object], part: str) -> None:
    sentence = told(name, values)
    assert part in sentence
    assert sentence.endswith(".")
    assert "nan" not in sentence


def test_every_effect_of_the_catalogue_has_a_sentence_and_a_case() -> None:
    names = {kind.name for kind in departures()}
    assert names == set(SENTENCES) == {name for name, _, _ in CASES}


def test_a_number_without_uncertainty_has_three_digits() -> None:
    kind = effect_named("lag")
    assert issubclass(kind, Departure)
    estimates = {"share": Estimate(0.01234, math.nan, "1")}
    assert "1.23 % of" in sentence_of(Telling(kind(share=0.01234), estimates, SCALES))
