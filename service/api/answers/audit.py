"""The audit log, as the service tells it."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from service.store.audit import AuditEntry
from service.store.pages import Page


class AuditAnswer(BaseModel):
    """One thing that was done."""

    model_config = ConfigDict(from_attributes=True, frozen=True)

    number: int = Field(description="From 1 on, without gaps.")
    at: datetime
    who: str
    key_id: str = Field(description="The key that they showed; empty on this machine.")
    action: str = Field(examples=["coefficient-set.certified"])
    subject: str = Field(description="What it was done to.")
    before: dict[str, Any] | None
    after: dict[str, Any] | None
    digest: str = Field(
        min_length=64, max_length=64, description="SHA-256 over the digest before it and this."
    )


class AuditPage(BaseModel):
    """Some entries, newest first."""

    items: tuple[AuditAnswer, ...]
    next_before: int | None = Field(description="Ask with `before` for those that follow.")

    @classmethod
    def of(cls, page: Page[AuditEntry]) -> "AuditPage":
        """Return the answer for a page of entries."""
        return cls(
            items=tuple(AuditAnswer.model_validate(each) for each in page.items),
            next_before=page.next_before,
        )


class AuditProof(BaseModel):
    """Every entry follows from those before it."""

    entries: int
    digest: str = Field(
        description="Of the last entry; kept elsewhere, it shows whether the end was cut off."
    )
