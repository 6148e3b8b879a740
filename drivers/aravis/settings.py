"""Our settings and the camera's features: written in an order that works, then all read back."""

from collections.abc import Sequence
from dataclasses import dataclass

from drivers.aravis import feature_names as names
from drivers.aravis.features import Features
from drivers.aravis.level import Level
from drivers.aravis.scan_kind import AREASCAN, LINESCAN, ScanKind
from drivers.pixel_formats import FORMATS
from drivers.ports import CameraSettings, PixelFormat


@dataclass(frozen=True)
class RawSteps:
    """What one step of a raw setting is worth, for cameras that have no other; None: unknown."""

    gain_db: float | None = None
    black_level_dn: float | None = None


UNKNOWN_STEPS = RawSteps()


@dataclass(frozen=True)
class SettingsWriter:
    """Applies settings to a camera that is not acquiring.

    Attributes:
        features: The camera's.
        raw_steps: What the steps of its raw settings are worth.
    """

    features: Features
    raw_steps: RawSteps = UNKNOWN_STEPS

    def apply(self, wanted: CameraSettings) -> CameraSettings:
        """Write `wanted`; return what the camera uses, read back once everything is written.

        Raises:
            SettingRefusedError: Names the feature, what was wanted and what was got.
        """
        self._check_kind(wanted)
        self._quieten()
        self._write_image(wanted)
        self._write_times(wanted)
        self._gain.write(self.features, wanted.gain_db)
        gain_db = self._gain.read(self.features)
        self._black_level.write(self.features, wanted.black_level_dn)
        used = self.read()
        self._check_nothing_moved(wanted, used)
        if used.gain_db != gain_db:
            raise self.features.refused(
                f"gain_db: wanted {wanted.gain_db:g}, it reads back {used.gain_db:g} once the black"
                " level is set",
                "setting-not-taken",
            )
        return used

    def read(self) -> CameraSettings:
        """Return the camera's settings as they are."""
        read = self.features.number
        rate_hz = read(self.features.required(self._kind.rate_hz))
        height = int(read(self.features.required(names.ROWS)))
        is_area = self._kind is AREASCAN
        return CameraSettings(
            exposure_us=read(self.features.required(names.EXPOSURE_US)),
            line_period_us=1e6 / rate_hz,
            frame_lines=1 if is_area else height,
            n_columns=int(read(self.features.required(names.COLUMNS))),
            first_column=self._offset(names.FIRST_COLUMN),
            n_rows=height if is_area else None,
            first_row=self._offset(names.FIRST_ROW) if is_area else 0,
            pixel_format=self._pixel_format(),
            gain_db=self._gain.read(self.features),
            black_level_dn=self._black_level.read(self.features),
        )

    @property
    def _kind(self) -> ScanKind:
        told = self.features.first_of(names.SCAN_KIND)
        return AREASCAN if told and self.features.text(told) == "Areascan" else LINESCAN

    def _check_kind(self, wanted: CameraSettings) -> None:
        """Rows, and single exposures as frames, are what an area camera alone is asked for."""
        is_area = self._kind is AREASCAN
        as_area = wanted.n_rows is not None and wanted.frame_lines == 1
        as_lines = wanted.n_rows is None and wanted.first_row == 0
        if as_area if is_area else as_lines:
            return
        has = "an area camera: give n_rows, and frame_lines = 1" if is_area else "a linescan camera"
        raise self.features.refused(
            f"n_rows = {wanted.n_rows}, first_row = {wanted.first_row}, frame_lines ="
            f" {wanted.frame_lines}: it is {has}",
            "setting-out-of-range",
        )

    def _offset(self, offset_names: Sequence[str]) -> int:
        offset = self.features.first_of(offset_names)
        return int(self.features.number(offset)) if offset else 0

    @property
    def _gain(self) -> Level:
        return Level("gain_db", names.GAIN_DB, names.GAIN_RAW, self.raw_steps.gain_db)

    @property
    def _black_level(self) -> Level:
        return Level(
            "black_level_dn",
            names.BLACK_LEVEL_DN,
            names.BLACK_LEVEL_RAW,
            self.raw_steps.black_level_dn,
        )

    def _pixel_format(self) -> PixelFormat:
        name = self.features.text(self.features.required(names.PIXEL_FORMAT))
        if name not in FORMATS:
            raise self.features.refused(
                f"cannot read pixel format {name}; set one of {', '.join(FORMATS)}",
                "pixel-format-unknown",
            )
        return name

    def _quieten(self) -> None:
        """Take back what an earlier client may have left: triggers, automatics, test patterns."""
        for feature in names.AUTOMATIC:
            self.features.write_entry_where_there(feature, "Off")
        for selected in self.features.entries("TriggerSelector"):
            self.features.write_entry("TriggerSelector", selected)
            self.features.write_entry_where_there("TriggerMode", "Off")
        self.features.write_entry_where_there("AcquisitionMode", "Continuous")
        self.features.write_entry_where_there("ExposureMode", "Timed")
        self.features.write_switch_where_there(self._kind.rate_switch, True)

    def _write_image(self, wanted: CameraSettings) -> None:
        self.features.write_entry(self.features.required(names.PIXEL_FORMAT), wanted.pixel_format)
        self._write_side(names.COLUMNS, wanted.n_columns, names.FIRST_COLUMN, wanted.first_column)
        height = wanted.frame_shape[0]
        if self._kind is AREASCAN:
            self._write_side(names.ROWS, height, names.FIRST_ROW, wanted.first_row)
        else:
            self.features.write_number(self.features.required(names.ROWS), height)

    def _write_side(
        self, size_names: Sequence[str], size: int, offset_names: Sequence[str], first: int
    ) -> None:
        write = self.features.write_number
        offset = self.features.first_of(offset_names)
        if offset:  # to the edge first: the size may grow only as far as the offset lets it
            write(offset, self.features.bounds(offset).low)
        write(self.features.required(size_names), size)
        if offset:
            write(offset, first)
        elif first:
            raise self.features.refused(
                f"it is to begin at {first}, but has no {offset_names[0]}", "feature-unknown"
            )

    def _write_times(self, wanted: CameraSettings) -> None:
        """Write exposure and rate so that the exposure fits into the period at any moment."""
        exposure = self.features.required(names.EXPOSURE_US)
        rate = self.features.required(self._kind.rate_hz)
        if not wanted.line_period_us > 0:
            raise self.features.refused(
                f"line_period_us = {wanted.line_period_us:g} is not above 0", "setting-out-of-range"
            )
        now_period_us = 1e6 / self.features.number(rate)
        steps = [(exposure, wanted.exposure_us), (rate, 1e6 / wanted.line_period_us)]
        if wanted.exposure_us > now_period_us:
            steps.reverse()
        for feature, value in steps:
            self.features.write_number(feature, value)

    def _check_nothing_moved(self, wanted: CameraSettings, used: CameraSettings) -> None:
        """A later setting may move an earlier one; each was checked only when it was written."""
        checks = (
            (names.ROWS, wanted.frame_shape[0], used.frame_shape[0]),
            (names.COLUMNS, wanted.n_columns, used.n_columns),
            (names.EXPOSURE_US, wanted.exposure_us, used.exposure_us),
            (self._kind.rate_hz, 1e6 / wanted.line_period_us, 1e6 / used.line_period_us),
        )
        for feature, want, got in checks:
            name = self.features.required(feature)
            step = self.features.bounds(name).step
            tolerance = step if isinstance(want, float) else 0.0
            self.features.check_taken(name, want, got, tolerance=tolerance)
        begins = (
            (names.FIRST_COLUMN, wanted.first_column, used.first_column),
            (names.FIRST_ROW, wanted.first_row, used.first_row),
        )
        for offset_names, want, got in begins:
            if want != got:
                raise self.features.refused(
                    f"{offset_names[0]}: wanted {want}, it reads back {got}", "setting-not-taken"
                )
        if used.pixel_format != wanted.pixel_format:
            raise self.features.refused(
                f"PixelFormat: wanted {wanted.pixel_format}, it reads back {used.pixel_format}",
                "setting-not-taken",
            )
