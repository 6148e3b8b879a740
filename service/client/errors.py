"""How the service's answers become errors: with the code that it gave."""

from typing import Any

from calib.errors import DarkflatError


class ProblemError(DarkflatError):
    """The service refused, or could not.

    Attributes:
        status: The HTTP status.
        device: Which device failed; empty where none did.
        last_exchange: The last bytes exchanged with it.
        standing: The coefficient sets that stand in the way of a certification.
    """

    def __init__(self, status: int, told: dict[str, Any]) -> None:
        """`told` is the body, as RFC 9457 has it."""
        detail = str(told.get("detail", f"the service answered {status} without a reason"))
        super().__init__(detail, code=str(told.get("code", f"http-{status}")))
        self.status = status
        self.device = str(told.get("device") or "")
        self.last_exchange = str(told.get("last_exchange") or "")
        self.standing: tuple[str, ...] = tuple(told.get("standing") or ())


class ServiceLostError(DarkflatError):
    """Nothing answers, or the connection broke and what was asked may not be asked twice."""

    def __init__(self, url: str, why: Exception) -> None:
        super().__init__(
            f"{url} does not answer ({why or type(why).__name__}); see whether `darkflat serve`"
            " runs there, and ask again",
            code="service-lost",
        )


class WorkFailedError(DarkflatError):
    """A run or a job came to another end than hoped for; `state` says which."""

    def __init__(self, message: str, *, code: str, state: str) -> None:
        super().__init__(message, code=code)
        self.state = state
