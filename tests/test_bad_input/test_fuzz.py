"""Files of text, changed at random: read, or refused with a `DarkflatError`; never a traceback."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.errors import DarkflatError
from calib.forward.model import Model
from calib.recording.folder_recording import FolderRecording
from service.bench.settings import BenchSettings
from service.cli.radiance_csv import read_radiances
from service.plan.describe import describe
from service.plan.model import Plan

FEW = settings(
    max_examples=100,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
TOKEN = re.compile(r"[\w.+-]+|[^\w\s]|\n")
ODD_WORDS = r"""
nan inf -inf -0 0 -1 1e400 1e-400 9999999999999999999999 0x10 1_000 true false "" '' "x"
2026-11-22 2026-11-22T09:30:00 2026-11-22T09:30:00Z 25:00:00 [] [[]] [1,"a"] {} {a=1} {a={b=1}}
[camera] [[camera]] [effects.adc] ../.. / \ \u0000 # , ; = . ..
None null dark flat scene sphere listed level exposure random mock gen mightex
"""
ODD = st.sampled_from([*ODD_WORDS.split(), "\u2028", "\ufeff"]) | st.text(max_size=6)

Read = Callable[[Path], object]


@st.composite
def changed(draw: st.DrawFn, text: str) -> str:
    """Return `text` with up to four of its tokens or lines replaced, dropped, doubled or moved."""
    for _ in range(draw(st.integers(1, 4))):
        places = [match.span() for match in TOKEN.finditer(text)]
        if not places:
            break
        first, last = draw(st.sampled_from(places))
        lines = text.split("\n")
        line = draw(st.integers(0, len(lines) - 1))
        text = draw(
            st.sampled_from(
                [
                    text[:first] + draw(ODD) + text[last:],
                    text[:first] + text[last:],
                    text[:first] + text[first:last] * 2 + text[last:],
                    text[:first],
                    "\n".join(lines[:line] + lines[line + 1 :]),
                    "\n".join([*lines[:line], lines[line], *lines[line:]]),
                    "\n".join([*lines[line:], *lines[:line]]),
                ]
            )
        )
    return text


def attempted(read: Read, path: Path, content: bytes) -> None:
    """Read `path` with other content; any error but a sentence of ours comes through."""
    path.write_bytes(content)
    try:
        read(path)
    except DarkflatError as error:
        assert str(error)  # noqa: PT017 - what else it is does not matter
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", error.code)  # noqa: PT017


def drawn(path: Path) -> None:
    """Load a model and ask it for what a simulation asks first."""
    Model.load(path).truth()


READERS: dict[str, Read] = {
    "rec/recording.toml": lambda path: FolderRecording(path.parent),
    "rec/conditions.csv": lambda path: FolderRecording(path.parent).provenance,
    "plan.toml": lambda path: describe(Plan.load(path)),
    "model.toml": drawn,
    "bench.toml": BenchSettings.load,
    "radiances.csv": read_radiances,
}


@pytest.mark.parametrize("name", READERS)
def test_a_changed_text_is_read_or_refused(name: str, sound: Path, tmp_path: Path) -> None:
    work = shutil.copytree(sound, tmp_path / "work")
    whole = (sound / name).read_text(encoding="utf-8")

    @FEW
    @given(changed(whole))
    def attempt(text: str) -> None:
        attempted(READERS[name], work / name, text.encode("utf-8", "surrogatepass"))

    attempt()


@pytest.mark.parametrize("name", READERS)
def test_changed_bytes_are_read_or_refused(name: str, sound: Path, tmp_path: Path) -> None:
    work = shutil.copytree(sound, tmp_path / "work")
    whole = (sound / name).read_bytes()

    @FEW
    @given(st.lists(st.tuples(st.integers(0, len(whole) - 1), st.integers(0, 255)), max_size=5))
    def attempt(changes: list[tuple[int, int]]) -> None:
        content = bytearray(whole)
        for at, value in changes:
            content[at] = value
        attempted(READERS[name], work / name, bytes(content))

    attempt()
