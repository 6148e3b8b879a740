"""The audit log, read and proven."""

from collections.abc import Iterator

from service.api.answers.audit import AuditAnswer, AuditPage, AuditProof
from service.client.link import Link


class Audit:
    """`/v1/audit`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def all(self) -> Iterator[AuditAnswer]:
        """Yield every entry, newest first."""
        return self._link.pages(AuditPage, "/v1/audit")

    def verify(self) -> AuditProof:
        """Prove that the log is whole; ProblemError `audit-broken` where it is not."""
        return self._link.get(AuditProof, "/v1/audit/verify")
