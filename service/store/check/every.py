"""All there is, page by page."""

from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from service.store.pages import LARGEST, Page

Item = TypeVar("Item")


def every(list_page: Callable[..., Page[Item]], **filters: Any) -> Iterator[Item]:
    """Yield the items of all pages, newest first."""
    before: int | None = None
    while True:
        page = list_page(limit=LARGEST, before=before, **filters)
        yield from page.items
        before = page.next_before
        if before is None:
            return
