"""How runs and jobs end."""

from typing import Protocol, TypeVar

from service.api.answers.job import JobError
from service.client.errors import WorkFailedError

FINAL = frozenset({"succeeded", "failed", "cancelled", "interrupted"})


class _Work(Protocol):
    @property
    def id(self) -> str: ...
    @property
    def state(self) -> str: ...
    @property
    def error(self) -> JobError | None: ...


Work = TypeVar("Work", bound=_Work)


def succeeded(kind: str, work: Work) -> Work:
    """Return a run or a job that is over; WorkFailedError where it came to another end."""
    if work.state == "succeeded":
        return work
    text, code = f"{kind} {work.id} is {work.state}", f"{kind}-{work.state}"
    if work.error is not None:
        text, code = f"{text}: {work.error.message}", work.error.code
    raise WorkFailedError(text, code=code, state=work.state)
