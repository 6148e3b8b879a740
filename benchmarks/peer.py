"""A peer's code, in an environment of its own, taking its turns beside ours."""

import subprocess
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path

from benchmarks.race import OURS, Figure, race
from benchmarks.size import Size
from benchmarks.timing import OwnTime

_JOBS = Path(__file__).with_name("peers.py")
_ROUNDS = 3  # they are slow, and nothing is held against them


class PeerProcess:
    """Runs one of the jobs of `peers.py`; each call is a turn."""

    def __init__(self, python: Path, job: str, size: Size) -> None:
        self._process = subprocess.Popen(
            [str(python), str(_JOBS), job, str(size.n_lines), str(size.n_columns)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def __call__(self) -> OwnTime:
        """Let it do its job once; return the seconds that it took."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(BrokenPipeError):
            self._process.stdin.write("go\n")
            self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise RuntimeError("a peer died; see what it said above")
        return OwnTime(answer)

    def close(self) -> None:
        """Let it end."""
        self._process.communicate()


def race_with_peers(
    size: Size, work: float, ours: Callable[[], object], jobs: Mapping[str, str]
) -> dict[str, Figure]:
    """Return what each peer reached, by name; nothing without the peers' environment.

    Args:
        size: Of the work, and where the peers' Python is.
        work: In units of the rate.
        ours: The same work with our code.
        jobs: The peers' names, and what `peers.py` calls their jobs.
    """
    if size.peers is None:
        return {}
    figures = {}
    for name, job in jobs.items():
        with ExitStack() as stack:
            process = PeerProcess(size.peers, job, size)
            stack.callback(process.close)
            figures[name] = race(work, {OURS: ours, name: process}, rounds=_ROUNDS)[name]
    return figures
