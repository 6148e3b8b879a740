"""Whether the service is well."""

from service.api.answers.health import Alive, Ready
from service.client.link import Link


class Health:
    """`/healthz`, `/readyz` and `/metrics`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def alive(self) -> Alive:
        """Return once the service answers and does jobs."""
        return self._link.get(Alive, "/healthz")

    def ready(self) -> Ready:
        """Say that it can be worked with; ProblemError `bench-not-ready` while it cannot."""
        return self._link.get(Ready, "/readyz")

    def metrics(self) -> str:
        """Return its figures in Prometheus' text format."""
        return self._link.ask("GET", "/metrics", repeatable=True).decode("utf-8")
