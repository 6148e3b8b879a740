"""Whether a coefficient set may be applied to a camera's lines, and what to say where not."""

from dataclasses import dataclass
from datetime import UTC, datetime
from math import isclose

from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.provenance import Range
from calib.radiometric.correction.flags import Flag
from calib.recording.header import CameraHeader

_MUST_MATCH = ("serial", "band", "region", "gain_db", "black_level_dn", "bit_depth")
TEMPERATURE_MARGIN_C = 1.0
"""A sensor's thermometer and its place on the board do not agree better than this."""


@dataclass(frozen=True)
class Validity:
    """From when up to, but without, when a certified set holds; None is open. Naive is UTC."""

    valid_from: datetime | None = None
    valid_until: datetime | None = None

    def covers(self, at: datetime) -> bool:
        """Tell whether `at` lies within, as the store's look-up does: the end itself is outside."""
        when = _utc(at)
        after = self.valid_from is None or _utc(self.valid_from) <= when
        return after and (self.valid_until is None or when < _utc(self.valid_until))


@dataclass(frozen=True)
class Finding:
    """Something that speaks against applying a set; `refuse` where only force overrides it."""

    flag: Flag
    text: str
    refuse: bool


def mismatches(coefficients: CoefficientSet, camera: CameraHeader) -> list[Finding]:
    """Return how the camera differs from the one that was calibrated; unknown is different."""
    findings = []
    for name in _MUST_MATCH:
        calibrated, used = getattr(coefficients.camera, name), getattr(camera, name)
        if not _same(calibrated, used):
            text = f"{name} is {calibrated!r} in the set and {used!r} in the lines"
            findings.append(Finding(Flag.MISMATCHED, text, refuse=True))
    return findings


def _same(calibrated: str | float, used: str | float) -> bool:
    """Tell whether two settings are one; cameras step by more than spellings of a number differ."""
    if isinstance(calibrated, str) or isinstance(used, str):
        return calibrated == used
    return isclose(calibrated, used, rel_tol=0.0, abs_tol=1e-6)


def validity_findings(validity: Validity | None, at: datetime | None) -> list[Finding]:
    """Return whether the time of the lines lies outside the set's validity, or is unknown."""
    if validity is None or validity == Validity():
        return []
    if at is None:
        text = "the set has a validity range, but the time of the lines is not known"
    elif validity.covers(at):
        return []
    else:
        text = (
            f"the lines of {_utc(at).isoformat()} lie outside the set's validity, "
            f"{_limit(validity.valid_from)} to {_limit(validity.valid_until)}"
        )
    return [Finding(Flag.OUTSIDE_VALIDITY, text, refuse=True)]


def domain_findings(
    coefficients: CoefficientSet, exposure_us: float, temperature_c: float | None
) -> list[Finding]:
    """Return which conditions lie outside what the calibration has seen."""
    findings = []
    exposures = coefficients.domain.exposure_us
    if not _within(exposure_us, exposures, margin=1e-6 * exposure_us):
        text = f"the exposure of {exposure_us:g} µs lies outside {_span(exposures)} µs"
        findings.append(Finding(Flag.EXTRAPOLATED, text, refuse=False))
    temperatures = coefficients.domain.temperature_c
    if temperature_c is None or temperatures is None:
        return findings
    if not _within(temperature_c, temperatures, margin=TEMPERATURE_MARGIN_C):
        text = f"the sensor's {temperature_c:g} °C lie outside {_span(temperatures)} °C"
        findings.append(Finding(Flag.EXTRAPOLATED, text, refuse=False))
    return findings


def refuse(findings: list[Finding]) -> None:
    """Raise InputError `set-mismatch` or `outside-validity`, all findings in one sentence."""
    if not findings:
        return
    mismatched = any(finding.flag == Flag.MISMATCHED for finding in findings)
    msg = (
        f"The coefficient set is not for these lines ({'; '.join(f.text for f in findings)}): "
        "take the set that matches, or force it."
    )
    raise InputError(msg, code="set-mismatch" if mismatched else "outside-validity")


def _within(value: float, limits: Range, *, margin: float) -> bool:
    return limits[0] - margin <= value <= limits[1] + margin


def _span(limits: Range) -> str:
    return f"the calibrated {limits[0]:g} to {limits[1]:g}"


def _utc(at: datetime) -> datetime:
    return at.replace(tzinfo=UTC) if at.tzinfo is None else at.astimezone(UTC)


def _limit(at: datetime | None) -> str:
    return "open" if at is None else _utc(at).isoformat()
