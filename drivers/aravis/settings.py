"""Our settings and the camera's features: written in an order that works, then all read back."""

from dataclasses import dataclass

from drivers.aravis import feature_names as names
from drivers.aravis.features import Features
from drivers.aravis.level import Level
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
        if wanted.n_rows is not None or wanted.first_row:
            raise self.features.refused(
                f"n_rows = {wanted.n_rows}, first_row = {wanted.first_row}: it is driven as a "
                "linescan camera, which has none",
                "setting-out-of-range",
            )
        self._quieten()
        self._write_image(wanted)
        self._write_times(wanted)
        self._gain.write(self.features, wanted.gain_db)
        self._black_level.write(self.features, wanted.black_level_dn)
        used = self.read()
        self._check_nothing_moved(wanted, used)
        return used

    def read(self) -> CameraSettings:
        """Return the camera's settings as they are."""
        read = self.features.number
        line_rate_hz = read(self.features.required(names.LINE_RATE_HZ))
        offset = self.features.first_of(names.FIRST_COLUMN)
        return CameraSettings(
            exposure_us=read(self.features.required(names.EXPOSURE_US)),
            line_period_us=1e6 / line_rate_hz,
            frame_lines=int(read(self.features.required(names.FRAME_LINES))),
            n_columns=int(read(self.features.required(names.COLUMNS))),
            first_column=int(read(offset)) if offset else 0,
            pixel_format=self._pixel_format(),
            gain_db=self._gain.read(self.features),
            black_level_dn=self._black_level.read(self.features),
        )

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
        self.features.write_switch_where_there("AcquisitionLineRateEnable", True)

    def _write_image(self, wanted: CameraSettings) -> None:
        write = self.features.write_number
        self.features.write_entry(self.features.required(names.PIXEL_FORMAT), wanted.pixel_format)
        offset = self.features.first_of(names.FIRST_COLUMN)
        if offset:  # to the edge first: the width may grow only as far as the offset lets it
            write(offset, self.features.bounds(offset).low)
        write(self.features.required(names.COLUMNS), wanted.n_columns)
        if offset:
            write(offset, wanted.first_column)
        elif wanted.first_column:
            raise self.features.refused(
                f"first_column = {wanted.first_column}: it has no OffsetX", "feature-unknown"
            )
        write(self.features.required(names.FRAME_LINES), wanted.frame_lines)

    def _write_times(self, wanted: CameraSettings) -> None:
        """Write exposure and line rate so that the exposure fits into the period at any moment."""
        exposure = self.features.required(names.EXPOSURE_US)
        line_rate = self.features.required(names.LINE_RATE_HZ)
        if not wanted.line_period_us > 0:
            raise self.features.refused(
                f"line_period_us = {wanted.line_period_us:g} is not above 0", "setting-out-of-range"
            )
        now_period_us = 1e6 / self.features.number(line_rate)
        steps = [(exposure, wanted.exposure_us), (line_rate, 1e6 / wanted.line_period_us)]
        if wanted.exposure_us > now_period_us:
            steps.reverse()
        for feature, value in steps:
            self.features.write_number(feature, value)

    def _check_nothing_moved(self, wanted: CameraSettings, used: CameraSettings) -> None:
        """A later setting may move an earlier one; each was checked only when it was written."""
        checks = (
            (names.FRAME_LINES, wanted.frame_lines, used.frame_lines),
            (names.COLUMNS, wanted.n_columns, used.n_columns),
            (names.EXPOSURE_US, wanted.exposure_us, used.exposure_us),
            (names.LINE_RATE_HZ, 1e6 / wanted.line_period_us, 1e6 / used.line_period_us),
        )
        for feature, want, got in checks:
            name = self.features.required(feature)
            step = self.features.bounds(name).step
            tolerance = step if isinstance(want, float) else 0.0
            self.features.check_taken(name, want, got, tolerance=tolerance)
        if used.pixel_format != wanted.pixel_format:
            raise self.features.refused(
                f"PixelFormat: wanted {wanted.pixel_format}, it reads back {used.pixel_format}",
                "setting-not-taken",
            )
