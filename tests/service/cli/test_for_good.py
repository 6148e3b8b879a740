import gc
from collections.abc import Iterator

import pytest

from service.cli.for_good import for_good


@pytest.fixture(autouse=True)
def _unfrozen() -> Iterator[None]:
    yield
    gc.unfreeze()


def test_what_is_made_inside_is_not_looked_through_any_more() -> None:
    with for_good():
        assert not gc.isenabled()
        made: list[object] = [[]]
    assert gc.isenabled()
    assert gc.get_freeze_count() > 0
    assert not any(each is made for each in gc.get_objects())


def test_garbage_is_looked_for_again_where_it_fails() -> None:
    frozen = gc.get_freeze_count()
    with pytest.raises(ZeroDivisionError), for_good():
        raise ZeroDivisionError
    assert gc.isenabled()
    assert gc.get_freeze_count() == frozen
