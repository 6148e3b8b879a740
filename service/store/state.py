"""The life of a coefficient set."""

from enum import StrEnum
from typing import Final

from service.store.errors import IllegalTransitionError


class SetState(StrEnum):
    """Where a set stands; nothing is ever deleted."""

    DRAFT = "draft"
    VERIFIED = "verified"
    """Somebody looked at it, and its file bears the content that its name states."""
    CERTIFIED = "certified"
    SUPERSEDED = "superseded"
    """Another set holds from some time on; before it, this one still does."""
    REVOKED = "revoked"
    """Found wrong: holds for no time any more."""


NEXT: Final[dict[SetState, frozenset[SetState]]] = {
    SetState.DRAFT: frozenset({SetState.VERIFIED}),
    SetState.VERIFIED: frozenset({SetState.CERTIFIED}),
    SetState.CERTIFIED: frozenset({SetState.SUPERSEDED, SetState.REVOKED}),
    # What is superseded still holds for the time before; found wrong, it must be revocable.
    SetState.SUPERSEDED: frozenset({SetState.REVOKED}),
    SetState.REVOKED: frozenset(),
}


def check_transition(set_id: str, before: SetState, after: SetState) -> None:
    """Raise IllegalTransitionError unless a set may go from `before` to `after`."""
    if after in NEXT[before]:
        return
    possible = " or ".join(sorted(NEXT[before])) or "nothing else"
    raise IllegalTransitionError(
        f"coefficient set {set_id[:12]} is {before} and cannot become {after};"
        f" from here it can become {possible}"
    )
