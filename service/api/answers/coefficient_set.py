"""A coefficient set and its life, as the service tells them."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from service.store.pages import Page
from service.store.records import SetRecord
from service.store.state import SetState


class _Answer(BaseModel):
    model_config = ConfigDict(from_attributes=True, frozen=True)


class TransitionAnswer(_Answer):
    """One step of a set's life."""

    before: SetState | None
    after: SetState
    at: datetime
    by: str
    reason: str


class CertificationAnswer(_Answer):
    """For which times a set was certified; ends are excluded."""

    valid_from: datetime
    valid_until: datetime | None
    superseded_from: datetime | None
    superseded_by: str | None
    until: datetime | None = Field(description="When it stops to hold, whatever ends it.")


class SetAnswer(_Answer):
    """A coefficient set; `id` is the SHA-256 of its content."""

    id: str = Field(min_length=64, max_length=64)
    state: SetState
    camera_serial: str
    band: str
    gain_db: float
    bit_depth: int
    columns: int
    region: str = Field(description="First and, excluded, last column that were read out.")
    radiance_unit: str
    recording_digest: str
    added_at: datetime
    added_by: str
    certification: CertificationAnswer | None
    transitions: tuple[TransitionAnswer, ...]
    summary: dict[str, Any] = Field(description="The figures that a person asks for first.")


class SetPage(_Answer):
    """Some sets, newest first."""

    items: tuple[SetAnswer, ...]
    next_before: int | None = Field(description="Ask with `before` for those that follow.")

    @classmethod
    def of(cls, page: Page[SetRecord]) -> "SetPage":
        """Return the answer for a page of records."""
        return cls(
            items=tuple(SetAnswer.model_validate(each) for each in page.items),
            next_before=page.next_before,
        )
