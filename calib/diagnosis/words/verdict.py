"""The first sentences of a diagnosis: what a person reads who reads no more."""

from collections.abc import Sequence

from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.answer.finding import Finding

NAMES = {"cti": "charge transfer inefficiency", "adc_inl": "integral nonlinearity",
    "adc_dnl": "differential nonlinearity", "rts_pixels": "random telegraph signal",
    "brighter_fatter": "brighter-fatter"}  # fmt: skip
"""Names that are not written as they are spoken."""
_COUNTS = ("no", "one", "two", "three", "four", "five")


def spoken(name: str) -> str:
    """Return an effect's name as it is spoken."""
    return NAMES.get(name, name.replace("_", " "))


def first_sentence(diagnosis: Diagnosis) -> str:
    """Return what the verdict is, in one sentence."""
    return {
        "consistent": _consistent,
        "explained": _explained,
        "ambiguous": _ambiguous,
        "unexplained": _unexplained,
    }[diagnosis.verdict](diagnosis)


def either_of(finding: Finding) -> str:
    """Return the names that a finding may have: "lamp drift or gain drift"."""
    return _listed([spoken(c.effect) for c in finding.candidates], "or")


def _consistent(diagnosis: Diagnosis) -> str:
    n = len(diagnosis.figures.block_names)
    return (
        f"This recording shows nothing beyond the plain model: all of its {n} blocks are what "
        "DN = L·VE·QE·t + DN0, shot noise, read noise and chance make of the light."
    )


def _explained(diagnosis: Diagnosis) -> str:
    n = len(diagnosis.findings)
    if n == 1:
        return "One departure from the plain model was found and named; what remains is chance."
    count = _COUNTS[n] if n < len(_COUNTS) else str(n)
    return (
        f"{count.capitalize()} departures from the plain model were found and named; what remains "
        "is chance."
    )


def _ambiguous(diagnosis: Diagnosis) -> str:
    unsure = [either_of(f) for f in diagnosis.findings if len(f.candidates) > 1]
    return (
        "Something departs from the plain model, and this recording cannot tell what it is: "
        f"{'; and '.join(unsure)}."
    )


def _unexplained(diagnosis: Diagnosis) -> str:
    rest = diagnosis.unexplained
    sigma = 0.0 if rest is None else rest.significance_sigma
    if not diagnosis.findings:
        return (
            f"This recording departs from the plain model by {sigma:.0f} standard deviations, and "
            "no effect of the catalogue explains how."
        )
    names = _listed([spoken(f.effect.name) for f in diagnosis.findings], "and")
    return (
        f"Beyond {names} something remains, {sigma:.0f} standard deviations from chance, that no "
        "effect of the catalogue makes."
    )


def _listed(words: Sequence[str], last: str) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"
