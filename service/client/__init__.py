"""The service from Python, typed: `from service.client import Client`."""

from service.client.client import Client
from service.client.errors import ProblemError, ServiceLostError, WorkFailedError

__all__ = ["Client", "ProblemError", "ServiceLostError", "WorkFailedError"]
