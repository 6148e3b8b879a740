"""Reads and writes a camera's features: asked for by all their names, checked, read back."""

from collections.abc import Sequence
from dataclasses import dataclass

from drivers.aravis.gi_aravis import aravis, glib_error
from drivers.aravis.gi_errors import speaking
from drivers.aravis.gi_types import GiCamera
from drivers.errors import SettingRefusedError

_NO_STEP = 1e-300
"""Aravis tells the smallest double where a feature has no increment."""


@dataclass(frozen=True)
class Bounds:
    """The range and the step of a number; `step` is 0 where the camera tells none."""

    low: float
    high: float
    step: float

    def snapped(self, value: float) -> float:
        """Return the nearest value on the camera's grid."""
        if self.step <= 0:
            return value
        return self.low + round((value - self.low) / self.step) * self.step


class Features:
    """The features of one camera. Vendors differ in names: each method takes all it may have."""

    def __init__(self, camera: GiCamera, device: str) -> None:
        self._camera = camera
        self._device = device

    def first_of(self, names: Sequence[str]) -> str | None:
        """Return the first of `names` that the camera has, None where it has none."""
        with speaking(self._device, f"look for {names[0]}"):
            return next((n for n in names if self._camera.is_feature_available(n)), None)

    def required(self, names: Sequence[str]) -> str:
        """Return the first of `names` that the camera has.

        Raises:
            SettingRefusedError: Code `feature-unknown`; names what was looked for.
        """
        found = self.first_of(names)
        if found is None:
            raise self.refused(f"it has none of {', '.join(names)}", "feature-unknown")
        return found

    def number(self, name: str) -> float:
        """Return a number, be it an integer or a float feature."""
        with speaking(self._device, f"read {name}"):
            if self._is_float(name):
                return self._camera.get_float(name)
            return float(self._camera.get_integer(name))

    def bounds(self, name: str) -> Bounds:
        """Return the range of a number, as it is now: other settings may move it."""
        with speaking(self._device, f"read the range of {name}"):
            if self._is_float(name):
                low, high = self._camera.get_float_bounds(name)
                return Bounds(low, high, self._float_step(name))
            lowest, highest = self._camera.get_integer_bounds(name)
            return Bounds(lowest, highest, self._camera.get_integer_increment(name) or 1)

    def write_number(self, name: str, wanted: float) -> float:
        """Write a number; return what the camera then reads back.

        A float is rounded to the camera's step. An integer must lie on it: nobody else checks.

        Raises:
            SettingRefusedError: Out of range, off its step, read-only, or read back as something
                else by more than a step and 1 %; names the feature, the wanted and the got.
        """
        span = self.bounds(name)
        is_float = self._is_float(name)
        self._check_range(name, wanted, span)
        if not is_float and span.snapped(wanted) != wanted:
            raise self.refused(
                f"{name} = {wanted:g} is not a step of {span.step:g} from {span.low:g}; "
                f"{span.snapped(wanted):g} would do",
                "setting-off-step",
            )
        with speaking(self._device, f"write {name} = {wanted:g}"):
            if is_float:
                value = min(max(span.snapped(wanted), span.low), span.high)
                self._camera.set_float(name, value)
            else:
                self._camera.set_integer(name, int(wanted))
        got = self.number(name)
        self.check_taken(name, wanted, got, tolerance=span.step if is_float else 0.0)
        return got

    def check_taken(self, name: str, wanted: float, got: float, *, tolerance: float) -> None:
        """Raise SettingRefusedError where the camera reads back another value than it was given.

        A float may differ by `tolerance` or 1 %, whichever is more; the caller is told the value.
        """
        allowed = max(tolerance, 0.01 * abs(wanted)) if self._is_float(name) else tolerance
        if abs(got - wanted) > allowed * (1 + 1e-9):
            raise self.refused(
                f"{name}: wanted {wanted:g}, it reads back {got:g}", "setting-not-taken"
            )

    def text(self, name: str) -> str:
        """Return an enumeration's entry or a string."""
        with speaking(self._device, f"read {name}"):
            return self._camera.get_string(name)

    def write_entry(self, name: str, wanted: str) -> str:
        """Choose an entry of an enumeration; return what is read back.

        Raises:
            SettingRefusedError: It has no such entry (names those it has), or did not take it.
        """
        entries = self.entries(name)
        if wanted not in entries:
            raise self.refused(
                f"{name} has no entry {wanted}; it has {', '.join(entries)}", "setting-unknown"
            )
        with speaking(self._device, f"write {name} = {wanted}"):
            self._camera.set_string(name, wanted)
        got = self.text(name)
        if got != wanted:
            raise self.refused(f"{name}: wanted {wanted}, it reads back {got}", "setting-not-taken")
        return got

    def entries(self, name: str) -> tuple[str, ...]:
        """Return the entries of an enumeration; none where the camera has no such feature."""
        if self.first_of((name,)) is None:
            return ()
        with speaking(self._device, f"read the entries of {name}"):
            return tuple(self._camera.dup_available_enumerations_as_strings(name))

    def write_entry_where_there(self, name: str, wanted: str) -> None:
        """Choose an entry where the camera has the feature at all, and the entry."""
        if wanted in self.entries(name):
            self.write_entry(name, wanted)

    def write_switch_where_there(self, name: str, wanted: bool) -> None:
        """Set a boolean where the camera has it."""
        if self.first_of((name,)) is not None:
            with speaking(self._device, f"write {name} = {wanted}"):
                self._camera.set_boolean(name, wanted)

    def refused(self, what: str, code: str) -> SettingRefusedError:
        """Return the error that says `what` of this camera."""
        return SettingRefusedError(f"{self._device}: {what}", device=self._device, code=code)

    def _float_step(self, name: str) -> float:
        try:
            step = self._camera.get_float_increment(name)
        except glib_error():  # a register's description need not have one
            return 0.0
        return step if step > _NO_STEP else 0.0

    def _check_range(self, name: str, wanted: float, span: Bounds) -> None:
        slack = 1e-9 * max(abs(span.low), abs(span.high))
        if not span.low - slack <= wanted <= span.high + slack:
            raise self.refused(
                f"{name} = {wanted:g} is outside {span.low:g} .. {span.high:g}",
                "setting-out-of-range",
            )

    def _is_float(self, name: str) -> bool:
        with speaking(self._device, f"look at {name}"):
            return isinstance(self._camera.get_device().get_feature(name), aravis().GcFloat)
