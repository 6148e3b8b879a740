"""How much of what did not fit each finding of a diagnosis explains."""

from collections.abc import Mapping, Sequence
from typing import Any

from service.page.figures.plot import FIRST, SECOND, Figure, figure


def before_and_after(findings: Sequence[Mapping[str, Any]]) -> Figure:
    """Held-out deviance with and without each finding, strongest first."""
    names = [str(each["effect"]) for each in findings]
    bars = [
        {
            "type": "bar",
            "x": names,
            "y": [each.get(f"heldout_deviance_{when}") for each in findings],
            "name": when,
            "marker": {"color": color},
        }
        for when, color in (("before", SECOND), ("after", FIRST))
    ]
    return figure(
        bars, x="finding", y="held-out deviance", showlegend=True, barmode="group", bargap=0.6
    )
