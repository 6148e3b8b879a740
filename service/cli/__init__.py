"""The command line: one file per command. Nothing heavy is imported before a command runs."""

import sys

from service.first_off import lamps_off_first

__all__ = ["main"]


def main() -> None:
    """Run `darkflat`; lamps that a killed service left burning go off before its imports begin."""
    lamps_off_first(sys.argv[1:])
    from service.cli.app import main as run  # noqa: PLC0415  (takes long)

    run()
