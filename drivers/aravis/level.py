"""Gain and black level: in a unit where the camera has one, else in the vendor's raw steps."""

from collections.abc import Sequence
from dataclasses import dataclass

from drivers.aravis.features import Features


@dataclass(frozen=True)
class Level:
    """One such setting.

    Attributes:
        setting: Our name of it, with its unit.
        names: Features that have that unit.
        raw_names: Features in the vendor's own steps.
        per_raw: What one raw step is worth in our unit. Vendors choose it; where it is not
            given, the setting of such a camera stays at its lowest, which counts as 0.
    """

    setting: str
    names: Sequence[str]
    raw_names: Sequence[str]
    per_raw: float | None

    def write(self, features: Features, wanted: float) -> None:
        """Write it.

        Raises:
            SettingRefusedError: Out of range, or the camera has no such setting, or one in an
                unknown unit, and something else than 0 is wanted.
        """
        name = features.first_of(self.names)
        raw = features.first_of(self.raw_names)
        if name:
            features.write_number(name, wanted)
        elif raw and (wanted == 0 or self.per_raw):
            span = features.bounds(raw)
            steps = wanted / self.per_raw if self.per_raw else 0.0
            features.write_number(raw, span.snapped(span.low + steps))
        elif raw:
            raise features.refused(
                f"{self.setting} = {wanted:g}: its {raw} has a unit of its own; say what one step "
                "is worth, or leave it at 0",
                "raw-unit-unknown",
            )
        elif wanted:
            raise features.refused(
                f"{self.setting} = {wanted:g}: it has no {self.names[0]}", "feature-unknown"
            )

    def read(self, features: Features) -> float:
        """Return it in our unit; 0 where the camera has none, or in steps of unknown worth."""
        name = features.first_of(self.names)
        raw = features.first_of(self.raw_names)
        if name:
            return features.number(name)
        if raw is None or self.per_raw is None:
            return 0.0
        return (features.number(raw) - features.bounds(raw).low) * self.per_raw
