"""Lists come in pages, newest first."""

from typing import Annotated

from fastapi import Query

Limit = Annotated[int, Query(ge=1, le=500)]
Before = Annotated[int | None, Query(ge=0, le=2**63 - 1)]
"""The last page's `next_before`."""
