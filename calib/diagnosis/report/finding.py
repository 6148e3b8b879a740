"""What the page says of one finding."""

from dataclasses import dataclass

from calib.diagnosis.answer.absorbed import Absorbed
from calib.diagnosis.answer.diagnosis import AMBIGUOUS
from calib.diagnosis.answer.finding import Finding
from calib.diagnosis.words.apart import apart
from calib.diagnosis.words.verdict import either_of, spoken
from calib.report.rounded import number, printed_unit, quantity

Bar = tuple[str, float, str]


@dataclass(frozen=True)
class FindingText:
    """A finding in words and numbers.

    Attributes:
        name: As it is spoken.
        sentence, hid_as: For an operator.
        unsure: That it may be something else; empty where it cannot.
        seen: How sure it is seen, and how well it predicts.
        bars: Name, share in percent and text of each candidate.
        apart: What tells each other candidate from it.
        parameters: Name, and value with unit.
        hidden: Coefficients of the plain fit: name, alone, beside, difference.
    """

    name: str
    sentence: str
    hid_as: str
    unsure: str
    seen: str
    bars: tuple[Bar, ...]
    apart: tuple[str, ...]
    parameters: tuple[tuple[str, str], ...]
    hidden: tuple[tuple[str, str, str, str], ...]


def finding_text(finding: Finding) -> FindingText:
    """Return what the page says of `finding`."""
    second = finding.candidates[1].probability if len(finding.candidates) > 1 else 0.0
    unsure = f"It may be {either_of(finding)}." if second >= AMBIGUOUS else ""
    return FindingText(
        spoken(finding.effect.name),
        finding.sentence or finding.effect.physics,
        finding.hid_as,
        unsure,
        _seen(finding),
        tuple(
            (spoken(c.effect), round(100.0 * c.probability, 1), f"{100 * c.probability:.0f} %")
            for c in finding.candidates
        ),
        tuple(apart(finding.effect, c.effect) for c in finding.candidates[1:]),
        tuple((n, quantity(e.value, e.std, e.unit)) for n, e in finding.parameters.items()),
        tuple(_hidden(each) for each in finding.absorbed if each.weight > 0),
    )


def _seen(finding: Finding) -> str:
    before, after = finding.heldout_before, finding.heldout_after
    gain = before - after
    predicts = (
        f"lowers the deviance of blocks that the fit did not see by {gain:.0f}"
        if gain > 0
        else "does not lower the deviance of blocks that the fit did not see"
    )
    sigma = finding.significance_sigma
    seen = f"Seen at {sigma:.1f} standard deviations" if sigma > 0 else "Not seen by itself"
    return f"{seen}; it {predicts}, {100 * finding.fraction_explained:.0f} % of what they missed."


def _hidden(each: Absorbed) -> tuple[str, str, str, str]:
    relative = each.unit != "DN"
    size, std = (100.0 * x if relative else x for x in (each.difference, each.std))
    spread = each.std * (abs(each.beside) if relative else 1.0)
    unit = f" {printed_unit(each.unit)}"
    return (
        each.name,
        number(each.plain, spread) + unit,
        number(each.beside, spread) + unit,
        f"{quantity(size, std)} {'%' if relative else 'DN'}",
    )
