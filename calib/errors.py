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


def reason_of(error: Exception) -> str:
    """Return why a file cannot be read, without its name, which the sentence gives.

    >>> reason_of(FileNotFoundError(2, "No such file or directory", "plan.toml"))
    'No such file or directory'
    """
    if isinstance(error, UnicodeDecodeError):
        return f"byte {error.start} is not UTF-8"
    return (isinstance(error, OSError) and error.strerror) or str(error)
