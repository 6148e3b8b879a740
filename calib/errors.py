"""What darkflat says when it cannot do what was asked."""


class DarkflatError(Exception):
    """One sentence: what is wrong, where, and what to do about it.

    Attributes:
        code: Stable identifier in kebab-case, for scripts (and the problem type of the API).
    """

    def __init__(self, message: str, *, code: str) -> None:
        super().__init__(message)
        self.code = code


class InputError(DarkflatError):
    """A file, a folder or a parameter that cannot be used as it is."""


class NotDeterminedError(DarkflatError):
    """The recording is sound, but does not determine what was asked of it."""
