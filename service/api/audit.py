"""`/v1/audit`: what was done by whom, and that the log is whole."""

from fastapi import APIRouter

from service.api.access import Reader
from service.api.answers.audit import AuditPage, AuditProof
from service.api.dependencies import StoreDep
from service.api.openapi import problems
from service.api.paging import Before, Limit

router = APIRouter(prefix="/v1/audit", tags=["audit"])


@router.get("", responses=problems())
def list_entries(
    store: StoreDep,
    _reader: Reader,
    limit: Limit = 100,
    before: Before = None,
) -> AuditPage:
    """List what was done, newest first."""
    return AuditPage.of(store.audit.list(limit=limit, before=before))


@router.get("/verify", responses=problems())
def verify_audit(store: StoreDep, _reader: Reader) -> AuditProof:
    """Prove every entry against those before it; a problem names the first that does not follow."""
    entries, digest = store.audit.verify()
    return AuditProof(entries=entries, digest=digest)
