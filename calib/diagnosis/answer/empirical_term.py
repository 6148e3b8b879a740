"""A label for what has no name: the term that an amended model carries of a remainder."""

from dataclasses import dataclass
from typing import Any

from calib.forward.effects.empirical import Empirical


@dataclass(frozen=True)
class EmpiricalTerm:
    """The term, and how sure it is.

    Attributes:
        effect: The term as a link of the forward model.
        std_dn: Standard uncertainty at each knot, beside offsets and slopes.
        explained: Deviance of the means that it takes off.
        share: Of what the means hold beyond chance.
    """

    effect: Empirical
    std_dn: tuple[float, ...]
    explained: float
    share: float

    @property
    def text(self) -> str:
        """Return what is said of it."""
        name = "wall time" if self.effect.follows == "time" else f"the {self.effect.follows}"
        span = max(self.effect.add_dn) - min(self.effect.add_dn)
        return (
            f"A smooth term against {name}, {span:.2g} DN from its lowest to its highest point, "
            f"takes off {100 * self.share:.0f} % of it. The amended model carries it under the "
            "label `empirical`: a description, no explanation."
        )

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "label": "empirical", "follows": self.effect.follows, "at": list(self.effect.at),
            "add_dn": list(self.effect.add_dn), "std_dn": list(self.std_dn),
            "explained_deviance": self.explained, "share": self.share,
        }  # fmt: skip
