"""Records three blocks and dies at once: `python -m tests.test_bad_input.dying_writer a.h5`."""

import os
import signal
import sys
from pathlib import Path

from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import HEADER, blocks, codes, record


def main() -> None:
    writer = RecordingWriter.create(Path(sys.argv[1]), HEADER, 8)
    for block in blocks():
        record(writer, block, codes(block.block, 20))
    os.kill(os.getpid(), signal.SIGKILL)


if __name__ == "__main__":
    main()
