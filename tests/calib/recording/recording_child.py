"""Records blocks until killed: python -m … PATH N_BLOCKS FRAMES FRAME_LINES COLUMNS.

Prints the index of every frame that was acknowledged.
"""

import resource
import sys
from pathlib import Path

from calib.errors import DarkflatError
from calib.recording.header import CameraHeader, RecordingHeader
from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import blocks, codes


def main() -> None:
    path = Path(sys.argv[1])
    n_blocks, n_frames, frame_lines, columns, limit = map(int, sys.argv[2:])
    if limit:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    header = RecordingHeader(camera=CameraHeader(columns=columns, bit_depth=12))
    with (
        RecordingWriter.resume(path)
        if path.exists()
        else RecordingWriter.create(path, header, frame_lines)
    ) as writer:
        for block in blocks(n_blocks, lines=n_frames * frame_lines):
            if block.block in writer.whole_blocks:
                continue
            dn = codes(block.block, n_frames * frame_lines, header.camera)
            writer.begin_block(block)
            for k in range(n_frames):
                index = writer.append(dn[k * frame_lines : (k + 1) * frame_lines])
                sys.stdout.write(f"{index}\n")
                sys.stdout.flush()
            writer.end_block(block)


if __name__ == "__main__":
    try:
        main()
    except DarkflatError as error:
        sys.exit(error.code)
