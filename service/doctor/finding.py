"""What the doctor found."""

from dataclasses import dataclass
from typing import Literal

State = Literal["ok", "advice", "missing"]


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes:
        topic: What, in a word or two.
        state: `ok`; `advice`: works, but not well, or not for everything; `missing`: something
            that is needed is not there.
        text: What was found.
        remedy: The command that mends it, or what to do; empty where all is well.
    """

    topic: str
    state: State
    text: str
    remedy: str = ""
