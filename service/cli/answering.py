"""How every command answers: `--json`, one line on standard error, exit status 0 or 1."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.errors import DarkflatError, reason_of
from service.cli.stopping import StoppedError, stopping
from service.store.plain_json import dumps

if TYPE_CHECKING:
    from rich.console import Console

Json = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="FILE",
        help="Write the answer as JSON to FILE; - is standard output, which gets nothing else.",
    ),
]
"""The option that every command takes."""

FAILED = 1
"""The work could not be done. (2, wrong usage, is Typer's own.)"""


class Answer:
    """Takes what a command has to say and puts it where the caller wants it."""

    def __init__(self, json_to: str | None) -> None:
        self._json_to = json_to
        self.given = False

    @property
    def for_people(self) -> bool:
        """True where standard output is free for people."""
        return self._json_to != "-"

    def give(self, content: Any, show: Callable[["Console"], None] | None = None) -> None:
        """Answer with `content` as JSON, and with what `show` prints for people."""
        self.given = True
        self.write_json(content)
        if show is not None and self.for_people:
            from service.cli.consoles import output  # noqa: PLC0415

            with standard_output():
                show(output())

    def write_json(self, content: Any) -> None:
        """Write `content` where `--json` says, whole or not at all; nowhere without it."""
        if self._json_to == "-":
            with standard_output():
                sys.stdout.write(dumps(content))
        elif self._json_to is not None:
            from calib.recording.durable import disk_errors  # noqa: PLC0415

            with disk_errors(Path(self._json_to)):
                _write(Path(self._json_to), dumps(content))


@contextmanager
def standard_output() -> Iterator[None]:
    """Have what is printed leave this process here, where it can be told that it did not."""
    try:
        yield
        sys.stdout.flush()
    except OSError as error:
        # What is still buffered would be tried once more at the end, with a traceback.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        msg = f"the answer cannot be written to standard output ({reason_of(error)}): make room"
        raise DarkflatError(msg, code=_code(error)) from error


def _write(path: Path, text: str) -> None:
    if not path.parent.is_dir() or path.is_dir():
        msg = f"the answer cannot be written to {path}: name a file in a folder that is there"
        raise DarkflatError(msg, code="cannot-write")
    if path.exists() and not path.is_file():  # /dev/stdout, a pipe
        path.write_text(text, encoding="utf-8")
        return
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with partial.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def answering(json_to: str | None) -> Iterator[Answer]:
    """Run a command's work; turn what goes wrong into one line and exit status 1."""
    answer = Answer(json_to)
    try:
        with stopping():
            yield answer
    except DarkflatError as error:
        raise _failed(answer, str(error), error.code) from error
    except (StoppedError, KeyboardInterrupt) as error:
        raise _failed(answer, "stopped before the work was done", "cancelled") from error
    except OSError as error:
        raise _failed(answer, _about(error), _code(error)) from error
    except (typer.Exit, SystemExit):
        raise
    except MemoryError as error:
        text = f"there is not enough memory ({error}): ask for fewer columns, lines or blocks"
        raise _failed(answer, text, "out-of-memory") from error
    except Exception as error:
        if os.environ.get("DARKFLAT_TRACEBACK"):
            raise
        text = f"a defect in darkflat: {type(error).__name__}: {error}; please report it"
        text += " with what DARKFLAT_TRACEBACK=1 shows"
        raise _failed(answer, text, "internal-error") from error


def _failed(answer: Answer, message: str, code: str) -> typer.Exit:
    """Say why and return the way out."""
    line = " ".join(message.split())
    print(f"darkflat: {line}", file=sys.stderr)  # noqa: T201
    with suppress(DarkflatError, OSError):  # the one line has been said
        answer.write_json({"error": {"code": code, "message": line}})
    return typer.Exit(FAILED)


def _code(error: OSError) -> str:
    from calib.recording.durable import is_disk_full  # noqa: PLC0415

    return "disk-full" if is_disk_full(error) else "system-error"


def _about(error: OSError) -> str:
    where = f"{error.filename}: " if error.filename else ""
    return f"{where}{error.strerror or error}; look at the path, its rights and the room left"
