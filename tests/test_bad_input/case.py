"""What a case of bad input is: sound files, one damage, one command, and what must be said."""

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

Damage = Callable[[Path], object]
"""Changes one thing in a folder of sound files (see `sound.py`)."""


def nothing(_folder: Path) -> None:
    """Leave the sound files as they are: the command itself asks for what cannot be."""


@dataclass(frozen=True)
class Case:
    """One row of docs/bad-input.md.

    Attributes:
        situation: What is wrong, in the words of a person at the bench; unique.
        command: What is typed, in the folder of sound files.
        code: The stable code of the answer.
        where: What the sentence must name: the file, and the block, row or key in it.
        remedy: What the sentence must tell to do.
        damage: What was done to the sound files.
    """

    situation: str
    command: str
    code: str
    where: tuple[str, ...]
    remedy: str
    damage: Damage = nothing

    @property
    def arguments(self) -> tuple[str, ...]:
        """The command as the shell would give it."""
        return tuple(shlex.split(self.command))
