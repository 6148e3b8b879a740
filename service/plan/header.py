"""The recording header that a plan stands for."""

from datetime import datetime
from typing import Any

from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader
from service.plan.model import Plan


def recording_header(
    plan: Plan,
    *,
    columns: int,
    rows: int | None = None,
    first_column: int = 0,
    first_row: int = 0,
    sensor_columns: int | None = None,
    sensor_rows: int | None = None,
    blocks: tuple[Block, ...] = (),
    model: str = "",
    serial: str = "",
    band: str = "",
    started_at: datetime | None = None,
    **provenance: Any,
) -> RecordingHeader:
    """Return the header; the plan's text goes into the recording beside it.

    Args:
        plan: What is measured.
        columns: How many the camera really reads out.
        rows: Likewise; None of a linescan camera.
        first_column: Where they begin on the sensor, read back.
        first_row: Likewise.
        sensor_columns: Of the whole sensor; None where nobody knows.
        sensor_rows: Likewise.
        blocks: Those that are already known.
        model: What the camera says of itself; the plan's own text goes before it.
        serial: Likewise.
        band: What the bench knows of it; likewise.
        started_at: UTC; block times count from it.
        provenance: More keys for the header; readers keep them and say so.
    """
    camera = plan.camera
    return RecordingHeader(
        camera=CameraHeader(
            model=camera.model or model,
            serial=camera.serial or serial,
            columns=columns,
            rows=rows,
            first_column=first_column,
            first_row=first_row,
            sensor_columns=sensor_columns,
            sensor_rows=sensor_rows,
            bit_depth=camera.bit_depth,
            gain_db=camera.gain_db,
            black_level_dn=camera.black_level_dn,
            taps=camera.taps,
            tap_layout=camera.tap_layout,
            line_period_us=camera.line_period_us,
            band=camera.band or band,
            started_at=started_at,
        ),
        source=_source(plan),
        blocks=blocks,
        **provenance,
    )


def _source(plan: Plan) -> SourceHeader:
    known = plan.source.model_dump(exclude={"radiance", "lamps"})
    return SourceHeader(lamps=plan.lamp_count, **known)
