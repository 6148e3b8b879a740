"""What a recording says about itself: the camera, the source, and each block's conditions.

The names are those of `recording.toml` and `conditions.csv`, the folder in which recordings
are interchanged. Unknown keys are kept (`model_extra`) and reported, never silently dropped.
"""

from typing import Any, Literal

from pydantic import AwareDatetime, BaseModel, ConfigDict, Field

TapLayout = Literal["single", "odd_even", "halves", "quarters", "quadrants"]
BlockKind = Literal["dark", "flat", "scene"]
MOST_PIXELS = 1 << 20
"""Along a side; no sensor has as many, and a slip of the pen must not ask for all memory."""


class _Header(BaseModel):
    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)


class CameraHeader(_Header):
    """The camera and how it was set for the whole recording."""

    model: str = ""
    serial: str = ""
    columns: int = Field(gt=0, le=MOST_PIXELS)
    rows: int | None = Field(default=None, gt=0, le=MOST_PIXELS)
    """Area sensors only."""
    first_column: int = Field(default=0, ge=0, lt=MOST_PIXELS)
    """Where the columns that were read out begin on the sensor."""
    first_row: int = Field(default=0, ge=0, lt=MOST_PIXELS)
    sensor_columns: int | None = Field(default=None, gt=0, le=MOST_PIXELS)
    """Of the whole sensor; None where no more is known of it than was read out."""
    sensor_rows: int | None = Field(default=None, gt=0, le=MOST_PIXELS)
    bit_depth: int = Field(ge=8, le=16)
    """Codes run 0 .. 2**bit_depth - 1."""
    gain_db: float = 0.0
    black_level_dn: float = 0.0
    taps: int = Field(default=1, ge=1)
    tap_layout: TapLayout = "single"
    readout: Literal["left", "right", "both"] = "left"
    line_period_us: float | None = Field(default=None, gt=0)
    """From one line's start to the next's; from frame to frame of an area sensor."""
    band: str = ""
    started_at: AwareDatetime | None = None
    dtype: str | None = None
    """Of headerless .raw frames, e.g. "<u2"."""

    @property
    def full_scale_dn(self) -> int:
        """The highest code."""
        return (1 << self.bit_depth) - 1

    def content(self) -> dict[str, Any]:
        """Return what hashes of content are taken over: unknown values are left out.

        So is the start of the region where it is 0, which keeps the names of recordings and sets
        from before the region was recorded.

        >>> CameraHeader(columns=8, bit_depth=12).content().keys() & {"first_column", "first_row"}
        set()
        """
        told = self.model_dump(mode="json", exclude_none=True)
        at_0 = {name for name in ("first_column", "first_row") if told.get(name) == 0}
        return {name: value for name, value in told.items() if name not in at_0}

    @property
    def region(self) -> str:
        """Which columns of the sensor, and which rows: first and, excluded, last.

        >>> CameraHeader(columns=6144, first_column=1024, bit_depth=8).region
        '1024:7168'
        >>> CameraHeader(columns=320, rows=256, bit_depth=14).region
        '0:320,0:256'
        """
        along = f"{self.first_column}:{self.first_column + self.columns}"
        if self.rows is None:
            return along
        return f"{along},{self.first_row}:{self.first_row + self.rows}"


class SourceHeader(_Header):
    """The light, and what its certificate and whoever set it up state of it (type B)."""

    kind: Literal["sphere", "led", "lamp", "none"] = "none"
    lamps: int = Field(default=1, ge=0)
    identity: str = ""
    """Free text: make and serial number."""
    radiance_unit: str = "1"
    wavelength_nm: float | None = Field(default=None, gt=0)
    photons_per_pixel_per_us: float | None = Field(default=None, gt=0)
    """At level 1."""
    certificate_relative_std: float | None = Field(default=None, ge=0, lt=1)
    """Standard uncertainty (k = 1) of all radiances together. None, here and below: not stated."""
    level_relative_std: float | None = Field(default=None, ge=0, lt=1)
    """Standard uncertainty of each level's radiance apart from that."""
    nonuniformity_relative: float | None = Field(default=None, ge=0, lt=1)
    """Half-width ±h of a rectangular distribution over the field that the camera sees."""
    monitor_relative_std: float | None = Field(default=None, ge=0, lt=1)
    """Standard uncertainty of carrying the radiance over to the day of the recording."""
    standard: str = ""
    """The radiance standard that the certificate traces to."""
    certificate: str = ""
    """The certificate's identifier."""


class Block(_Header):
    """One block: lines or frames taken under the same conditions. None is unknown, not 0."""

    block: str
    kind: BlockKind
    exposure_us: float = Field(gt=0)
    level: float = Field(default=0.0, ge=0)
    started_s: float | None = None
    sensor_temperature_c: float | None = None
    lines: int | None = Field(default=None, ge=1)
    """Lines, or frames of an area sensor."""
    radiance: float | None = Field(default=None, ge=0)
    """Nominal, as the certificate says, in the source's `radiance_unit`."""
    monitor: float | None = None
    """The monitor photodiode's current, A."""
    scene: str | None = None
    """Names a radiance image under `scenes/`."""


class RecordingHeader(_Header):
    """Everything about a recording but its frames; `blocks` in the order of acquisition."""

    camera: CameraHeader
    source: SourceHeader = SourceHeader()
    blocks: tuple[Block, ...] = ()
