"""`/v1/audit`: what was done by whom, and that the log is whole."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.api.access import Reader
from service.api.answers.audit import AuditPage, AuditProof
from service.api.dependencies import StoreDep
from service.api.openapi import problems

router = APIRouter(prefix="/v1/audit", tags=["audit"])


@router.get("", responses=problems())
def list_entries(
    store: StoreDep,
    _reader: Reader,
    limit: Annotated[int, Query(ge=1, le=500)] = 100,
    before: Annotated[int | None, Query(ge=0, le=2**63 - 1)] = None,
) -> AuditPage:
    """List what was done, newest first."""
    return AuditPage.of(store.audit.list(limit=limit, before=before))


@router.get("/verify", responses=problems())
def verify_audit(store: StoreDep, _reader: Reader) -> AuditProof:
    """Prove every entry against those before it; a problem names the first that does not follow."""
    entries, digest = store.audit.verify()
    return AuditProof(entries=entries, digest=digest)
