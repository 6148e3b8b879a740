"""A plan of blocks in the form that `darkflat sweep` runs, its camera and source those recorded."""

from collections.abc import Sequence
from typing import Any

from calib.diagnosis.deciding.bench import Taken
from calib.recording.header import RecordingHeader

SEEN_CURRENT_A = (1e-15, 1.0)
"""Any current of a photodiode that sees light; a bench without a monitor is refused."""
_OF_CAMERA = ("line_period_us", "gain_db", "black_level_dn", "band", "taps", "tap_layout")


def plan_of(
    taken: Sequence[Taken], header: RecordingHeader, *, name: str, monitor: bool
) -> dict[str, Any]:
    """Return the plan of blocks."""
    lines = [int(each.block.lines or 1) for each in taken]
    plan: dict[str, Any] = {
        "name": name,
        "lines": max(set(lines), key=lines.count),
        "sweep": {"type": "listed", "blocks": [_listed(each) for each in taken]},
        "camera": _camera(header),
        "source": _source(header),
    }
    if monitor:
        plan["interlocks"] = {"monitor_a": list(SEEN_CURRENT_A)}
    return plan


def _listed(each: Taken) -> dict[str, Any]:
    block = each.block
    listed: dict[str, Any] = {
        "kind": block.kind, "exposure_us": block.exposure_us, "level": each.burning,
        "lines": int(block.lines or 1),
    }  # fmt: skip
    if each.wait_s > 0:
        listed["wait_s"] = round(each.wait_s, 3)
    if block.scene is not None:
        listed["scene"] = block.scene
    return listed


def _camera(header: RecordingHeader) -> dict[str, Any]:
    camera = header.camera
    told = {name: getattr(camera, name) for name in _OF_CAMERA}
    told |= {"pixel_format": f"Mono{camera.bit_depth}", "columns": camera.columns}
    told |= {"first_column": camera.first_column}
    if camera.rows is not None:
        told |= {"rows": camera.rows, "first_row": camera.first_row}
    if camera.line_period_us is None:
        told["line_period_us"] = max((b.exposure_us for b in header.blocks), default=1000.0)
    return told


def _source(header: RecordingHeader) -> dict[str, Any]:
    """Return the source as the recording states it, with the radiance of the levels it had."""
    stated = header.source.model_dump(
        exclude_none=True, exclude=set(header.source.model_extra or {})
    )
    levels = {
        f"{block.level:g}": block.radiance
        for block in header.blocks
        if block.kind == "flat" and block.radiance is not None
    }
    highest = max((block.level for block in header.blocks), default=0.0)
    if stated.get("kind") == "sphere" and stated.get("lamps", 0) < highest:
        stated.pop("lamps", None)
    return {**stated, **({"radiance": levels} if levels else {})}
