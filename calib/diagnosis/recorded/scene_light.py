"""Which blocks of a recording have light that is known, pixel by pixel."""

from collections.abc import Mapping

import numpy as np

from calib.arrays import Columns
from calib.recording.header import Block, RecordingHeader
from calib.recording.protocol import Recording


def steady_images(recording: Recording) -> Mapping[str, Columns]:
    """Return radiance along the columns, by scene, (n_columns,) each.

    A scene whose lines differ has no steady light: its noise cannot be told from its pattern.
    """
    images = getattr(recording, "scenes", {})
    lines = {name: np.atleast_2d(np.asarray(image, np.float64)) for name, image in images.items()}
    return {name: image[0] for name, image in lines.items() if (image == image[0]).all()}


def has_known_light(block: Block, header: RecordingHeader, images: Mapping[str, Columns]) -> bool:
    """Return whether a block's light is uniform, or that of an image."""
    return block.kind != "scene" or (block.scene in images and header.camera.rows is None)
