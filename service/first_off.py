"""What `darkflat serve` does before all else: it tells the lamps of its bench to go off.

They burn on where a service was killed together with its bench's process. All else that a start
does imports for the better part of a second, and on a busy machine for many: so the bench file is
read here without being checked, and nothing is imported but what sends a few bytes.
"""

import os
import tomllib
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from calib.errors import DarkflatError
from drivers.serial.blind_off import gen_off, mightex_off


def lamps_off_first(arguments: Sequence[str]) -> None:
    """Tell the lamps to go off where `arguments` of `darkflat` have a bench with lamps served.

    A port that somebody holds is left to them. What goes wrong is said when the bench is opened,
    right after this: there the lamps are told once more, and read back.
    """
    if arguments[:1] != ["serve"] or "--help" in arguments:
        return
    with suppress(DarkflatError, OSError, ValueError, TypeError, RecursionError):
        content = tomllib.loads(_bench_file(arguments).read_text(encoding="utf-8"))
        _tell(content.get("light"))


def _bench_file(arguments: Sequence[str]) -> Path:
    """Return the file that `service.cli.simulated_bench.chosen_bench` will choose."""
    named = os.environ.get("DARKFLAT_BENCH", "bench.toml")
    for option, value in zip(arguments, [*arguments[1:], ""], strict=True):
        if option == "--bench":
            named = value
        elif option.startswith("--bench="):
            named = option.removeprefix("--bench=")
    return Path(named)


def _tell(light: Any) -> None:
    match light:
        case {"driver": "gen", "port": str(port)}:
            gen_off(port, **_set(light, "baudrate"))
        case {"driver": "mightex", "port": str(port)}:
            mightex_off(port, **_set(light, "channel", "baudrate"))


def _set(light: dict[str, Any], *names: str) -> dict[str, Any]:
    """Return those that the file sets; the driver knows what holds for the others."""
    return {name: light[name] for name in names if name in light}
