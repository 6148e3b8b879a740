"""Which endings of file names are frames."""

from typing import Final

from calib.recording.formats import fits, npy, raw, tiff
from calib.recording.formats.frame_file import FrameFormat

FORMATS: Final[dict[str, FrameFormat]] = {
    ".npy": npy,
    ".tif": tiff,
    ".tiff": tiff,
    ".fits": fits,
    ".fit": fits,
    ".raw": raw,
}
"""By the ending of the file's name, in lower case."""
