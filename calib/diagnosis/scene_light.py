"""Which blocks of a recording have light that is known, pixel by pixel."""

from collections.abc import Mapping, Sequence

import numpy as np

from calib.arrays import Columns
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.recording.header import Block, RecordingHeader
from calib.recording.protocol import Recording


def steady_images(recording: Recording) -> Mapping[str, Columns]:
    """Return radiance along the columns, by scene, (n_columns,) each.

    A scene whose lines differ has no steady light: its noise cannot be told from its pattern.
    """
    images = getattr(recording, "scenes", {})
    lines = {name: np.atleast_2d(np.asarray(image, np.float64)) for name, image in images.items()}
    return {name: image[0] for name, image in lines.items() if (image == image[0]).all()}


def with_known_light(
    header: RecordingHeader, sums: Sequence[BlockSums], images: Mapping[str, Columns]
) -> tuple[RecordingHeader, tuple[BlockSums, ...]]:
    """Return the header and sums without scenes of which no steady image is there."""
    kept = [_is_known(block, header, images) for block in header.blocks]
    blocks = tuple(b for b, known in zip(header.blocks, kept, strict=True) if known)
    left = tuple(each for each, known in zip(sums, kept, strict=True) if known)
    return header.model_copy(update={"blocks": blocks}), left


def _is_known(block: Block, header: RecordingHeader, images: Mapping[str, Columns]) -> bool:
    return block.kind != "scene" or (block.scene in images and header.camera.rows is None)
