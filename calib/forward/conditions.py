"""Under which conditions lines are exposed: what the plan set and the surroundings imposed."""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns, Pixels
from calib.forward.left import Left


@dataclass(frozen=True)
class Conditions:
    """What holds while a stretch of lines is exposed; of an area sensor, a stretch of frames.

    Attributes:
        exposure_us: Exposure time of each line.
        line_period_us: Time from one line's start to the next's, or from frame to frame.
        line_times_s: Wall time of each line, or frame, since the recording started, (n_lines,).
        lamps: Relative emission of each lamp now, 1 = its own nominal radiance; warm-up included.
            An LED is one lamp whose emission is its setting relative to the nominal one.
        level: The number of lamps that burn, or the LED's setting; 0 in the dark.
        capped: True where no light reaches the sensor (a dark).
        sensor_temperature_c: The sensor's temperature.
        gain_db: The camera's own gain setting, on top of the model's system gain.
        black_level_dn: The camera's own black level, on top of the model's offset.
        before: What earlier lines left in the pixels; None for a sensor at rest.
    """

    exposure_us: float
    line_period_us: float
    line_times_s: Columns
    lamps: tuple[float, ...] = ()
    level: float = 0.0
    capped: bool = False
    sensor_temperature_c: float = 25.0
    gain_db: float = 0.0
    black_level_dn: float = 0.0
    before: Left | None = None

    @property
    def n_lines(self) -> int:
        """How many lines are exposed under these conditions."""
        return len(self.line_times_s)

    @property
    def ended_s(self) -> float:
        """When the last line's period is over, wall time."""
        return float(self.line_times_s[-1]) + self.line_period_us * 1e-6

    @property
    def idle_s(self) -> float:
        """Time from the end of the lines before to the first of these; 0 where there were none."""
        return 0.0 if self.before is None else max(self._first_s - self.before.at_s, 0.0)

    @property
    def follows_on(self) -> bool:
        """Whether these lines are the next ones after those drawn before, none between."""
        return (
            self.before is not None
            and self.before.drawn
            and self.idle_s < 0.5e-6 * self.line_period_us
        )

    def left_by(self, effect: str) -> Pixels | None:
        """Return what the effect of that name left in the pixels, (*sample,); None if nothing."""
        return None if self.before is None else self.before.states.get(effect)

    @property
    def _first_s(self) -> float:
        return float(self.line_times_s[0])

    @classmethod
    def steady(
        cls,
        n_lines: int,
        *,
        exposure_us: float,
        line_period_us: float,
        started_s: float = 0.0,
        lamps: tuple[float, ...] = (),
        capped: bool = False,
        sensor_temperature_c: float = 25.0,
        gain_db: float = 0.0,
        black_level_dn: float = 0.0,
    ) -> "Conditions":
        """Return conditions for `n_lines` successive lines from `started_s` on."""
        return cls(
            exposure_us=exposure_us,
            line_period_us=line_period_us,
            line_times_s=started_s + np.arange(n_lines, dtype=np.float64) * (line_period_us * 1e-6),
            lamps=lamps,
            level=float(sum(1 for emission in lamps if emission > 0)),
            capped=capped,
            sensor_temperature_c=sensor_temperature_c,
            gain_db=gain_db,
            black_level_dn=black_level_dn,
        )
