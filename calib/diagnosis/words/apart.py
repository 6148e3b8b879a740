"""What tells two effects apart that a recording confuses."""

from calib.diagnosis.words.verdict import spoken
from calib.forward.departure import Departure
from calib.forward.effects.catalogue import effect_named

PAIRS = {
    frozenset({"lamp_drift", "gain_drift"}): (
        "Both scale flats with wall time. A gain that drifts also scales the noise of darks and "
        "the ratio of variance to mean; a monitor of the light tells them apart at once."
    ),
    frozenset({"cti", "interpixel_capacitance"}): (
        "In uniform light they part only by how charge transfer inefficiency grows along the "
        "register and falls with the charge. A scene with an edge tells them apart."
    ),
    frozenset({"level_nonadditivity", "reciprocity_failure"}): (
        "Both follow the level; they differ in how they curve. More levels tell them apart."
    ),
    frozenset({"dark_current", "offset_drift"}): (
        "Both raise later blocks where exposures grow in order. Darks whose exposures are not in "
        "the order of time tell them apart."
    ),
    frozenset({"nonlinearity", "adc_inl"}): (
        "Both bend the response; over a short range of codes they are the same curve. Signals up "
        "to full scale tell them apart."
    ),
    frozenset({"stray_light", "exposure_offset"}): (
        "Without darks both shift flats alike. Darks, and flats at a second level, tell them apart."
    ),
}
"""Pairs that are the same in some recordings, and what parts them."""


def apart(own: Departure, other: str) -> str:
    """Return what tells the effect of the name `other` from `own`, by what each follows."""
    kind = effect_named(other)
    known = PAIRS.get(frozenset({own.name, other}))
    if known is not None:
        return known
    follows = tuple(getattr(kind, "depends_on", ()))
    mine: list[str] = [v for v in own.depends_on if v not in follows]
    its: list[str] = [v for v in follows if v not in own.depends_on]
    name, rival = spoken(own.name).capitalize(), spoken(other)
    if mine or its:
        both = ((name, mine), (rival, its))
        parts = [f"{who} follows {_listed(what)}" for who, what in both if what]
        return f"{'; '.join(parts)}: a recording in which these run independently tells them apart."
    shown = getattr(kind, "shows_in", own.shows_in)
    if shown != own.shows_in:
        return f"{name} shows first in {_words(own.shows_in)}, {rival} in {_words(shown)}."
    return (
        f"{name} and {rival} follow the same variables and differ in shape alone: more "
        "different signals, or more lines, tell them apart."
    )


def _listed(names: list[str]) -> str:
    words = [f"the {_words(name)}" for name in names]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _words(name: str) -> str:
    return name.replace("_", " ")
