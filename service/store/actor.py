"""Who asks for something."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Actor:
    """A person or a program; `key_id` names the key that it showed, empty on this machine."""

    name: str
    key_id: str = ""
