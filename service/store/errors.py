"""How the store answers what it cannot do."""

from collections.abc import Sequence

from calib.errors import DarkflatError


class StoreError(DarkflatError):
    """The store cannot be used as it is: not writable, busy, of another version."""


class NotInStoreError(DarkflatError):
    """Nothing is known by that name."""

    def __init__(self, message: str) -> None:
        super().__init__(message, code="not-found")


class IllegalTransitionError(DarkflatError):
    """A coefficient set's life does not go that way."""

    def __init__(self, message: str) -> None:
        super().__init__(message, code="illegal-transition")


class OverlapError(DarkflatError):
    """Two sets would hold for the same camera setting at the same time.

    Attributes:
        standing: The sets that stand in the way; name them to supersede them.
    """

    def __init__(self, message: str, standing: Sequence[str]) -> None:
        super().__init__(message, code="overlapping-certification")
        self.standing = tuple(standing)
