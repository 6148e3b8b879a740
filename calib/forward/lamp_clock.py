"""What lamps emit as wall time goes on, switched now and then."""

from dataclasses import dataclass, replace

from calib.forward.effects.illumination import Illumination


@dataclass(frozen=True)
class LampClock:
    """Lamps on their way from what they emitted when last switched to their target.

    Attributes:
        illumination: The lamps.
        start, target: Relative emission of each lamp at the switch, and long after.
        switched_s: Wall time of the switch.
    """

    illumination: Illumination
    start: tuple[float, ...]
    target: tuple[float, ...]
    switched_s: float = 0.0

    @classmethod
    def cold(cls, illumination: Illumination) -> "LampClock":
        """Return lamps that have been off for long, at time 0."""
        dark = (0.0,) * len(illumination.radiance)
        return cls(illumination, dark, dark)

    def emissions(self, at_s: float) -> tuple[float, ...]:
        """Return the relative emission of each lamp at a time from the switch on."""
        return tuple(
            self.illumination.emission(lamp, start, target, at_s - self.switched_s)
            for lamp, (start, target) in enumerate(zip(self.start, self.target, strict=True))
        )

    def switch(self, target: tuple[float, ...], at_s: float) -> "LampClock":
        """Return the lamps sent to `target` at `at_s`; those that stay are not disturbed."""
        if target == self.target:
            return self
        return replace(self, start=self.emissions(at_s), target=target, switched_s=at_s)
