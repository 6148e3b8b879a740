"""What commands say of a recording that they wrote."""

from collections.abc import Callable
from typing import Any

from rich.console import Console

from calib.recording.protocol import Recording


def summary(recording: Recording) -> dict[str, Any]:
    """Return camera, blocks and warnings, ready for JSON."""
    header = recording.header
    return {
        "recording": str(recording.path),
        "camera": header.camera.model_dump(mode="json", exclude_none=True),
        "blocks": len(header.blocks),
        "lines": sum(block.lines or 0 for block in header.blocks),
        "warnings": list(recording.warnings),
    }


def show(told: dict[str, Any]) -> Callable[[Console], None]:
    """Return what prints a summary for people."""

    def to(console: Console) -> None:
        camera = told["camera"]
        console.print(
            f"{told['recording']}: {told['blocks']} blocks, {told['lines']} lines of"
            f" {camera['columns']} columns, {camera['bit_depth']} bits",
            markup=False,
        )
        for warning in told["warnings"]:
            console.print(f"! {warning}", markup=False)

    return to
