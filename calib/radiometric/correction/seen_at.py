"""When and how lines were taken, as far as the departures of a set ask for it."""

from dataclasses import dataclass
from datetime import datetime

from calib.forward.departure import Departure, Variable
from calib.forward.effect import Stage
from calib.forward.effects.empirical import Empirical
from calib.forward.schedule import AMBIENT_C
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.departures import Departures
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class SeenAt:
    """Conditions of lines.

    Attributes:
        time_s: Of the first line, since the calibration's recording started.
        temperature_c: Of the sensor.
        line_period_us: From line to line.
        gain_db: As the camera is set.
        notes: What was not known, and what stands for it.
    """

    time_s: float
    temperature_c: float
    line_period_us: float
    gain_db: float
    notes: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        coefficients: CoefficientSet,
        departures: Departures,
        camera: CameraHeader,
        *,
        at: datetime | None,
        temperature_c: float | None,
    ) -> "SeenAt":
        """Return the conditions; what nobody tells is taken from the middle of the calibration.

        There the set with its departures says what a set without them would have said.
        """
        notes = []
        time_s = _since(coefficients.provenance.started_at, at)
        if time_s is None and (names := _following(departures, "time")):
            notes.append(f"when the lines were taken is not known: {names} as when calibrating")
        usual_c = AMBIENT_C if departures.temperature_c is None else departures.temperature_c
        if temperature_c is None and (names := _following(departures, "temperature")):
            notes.append(f"the sensor's temperature is not known: {names} as when calibrating")
        return cls(
            departures.time_s if time_s is None else time_s,
            usual_c if temperature_c is None else temperature_c,
            camera.line_period_us or departures.line_period_us,
            camera.gain_db,
            tuple(notes),
        )


def _since(started_at: str, at: datetime | None) -> float | None:
    """Return the time from the calibration's start to `at`, s; not before it, None if unknown."""
    if not started_at or at is None:
        return None
    started = datetime.fromisoformat(started_at)
    zoned = at if at.tzinfo else at.replace(tzinfo=started.tzinfo)
    return max((zoned - started).total_seconds(), 0.0)


def _following(departures: Departures, variable: Variable) -> str:
    """Return the names of the camera's departures that follow a variable alone of all; "" if none.

    Of memory, only the time between lines counts, which is known.
    """

    def follows(d: Departure | Empirical) -> bool:
        return d.stage > Stage.SOURCE and variable == d.depends_on[0]

    return ", ".join(d.name for d in departures.departures if follows(d))
