"""A recording, as the service tells it."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from service.store.pages import Page
from service.store.records import RecordingRecord


class RecordingAnswer(BaseModel):
    """A recording; `digest` is the SHA-256 over header and frames."""

    model_config = ConfigDict(from_attributes=True, frozen=True)

    digest: str = Field(min_length=64, max_length=64)
    name: str
    camera_serial: str
    band: str
    started_at: datetime | None
    registered_at: datetime
    registered_by: str
    header: dict[str, Any] = Field(description="Camera, source and blocks, as in the file.")
    warnings: tuple[str, ...]


class RecordingPage(BaseModel):
    """Some recordings, newest first."""

    items: tuple[RecordingAnswer, ...]
    next_before: int | None = Field(description="Ask with `before` for those that follow.")

    @classmethod
    def of(cls, page: Page[RecordingRecord]) -> "RecordingPage":
        """Return the answer for a page of records."""
        return cls(
            items=tuple(RecordingAnswer.model_validate(each) for each in page.items),
            next_before=page.next_before,
        )
