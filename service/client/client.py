"""One object for all of the service."""

from calib.closing import Closing
from service.client.audit import Audit
from service.client.bench import Bench
from service.client.coefficient_sets import CoefficientSets
from service.client.health import Health
from service.client.jobs import Jobs
from service.client.link import Link
from service.client.recordings import Recordings
from service.client.runs import Runs


class Client(Closing):
    """A service and a key. Thread-safe; a context manager. Errors are DarkflatErrors.

    Attributes:
        bench: What it does, `safe_off`, and `release`.
        runs: Plans that it measures.
        recordings: What came of them, or was uploaded.
        jobs: Calibrations, photon transfers, diagnoses, transfer functions.
        coefficient_sets: Their lives, and radiance by them.
        audit: What was done by whom.
        health: Whether it can be worked with.
    """

    def __init__(
        self,
        url: str = "http://127.0.0.1:8642",
        *,
        key: str | None = None,
        patience_s: float = 10.0,
    ) -> None:
        """Nothing is asked yet.

        Args:
            url: Where `darkflat serve` answers.
            key: Made by `darkflat key create`; None where the service has none yet.
            patience_s: How long a service that is away is waited for, where asking twice is safe.
        """
        self._link = Link(url, key=key, patience_s=patience_s)
        self.bench = Bench(self._link)
        self.runs = Runs(self._link)
        self.recordings = Recordings(self._link)
        self.jobs = Jobs(self._link)
        self.coefficient_sets = CoefficientSets(self._link)
        self.audit = Audit(self._link)
        self.health = Health(self._link)

    def safe_off(self) -> bool:
        """Switch every lamp off, whoever has the bench; say whether all read back as off."""
        return self.bench.safe_off().dark

    def close(self) -> None:
        """Release the connections; safe to call twice."""
        self._link.close()
