import threading

import pytest

from calib.recording.behind import Behind


def test_parts_are_done_in_order_and_all_of_them() -> None:
    done: list[int] = []
    with Behind(3) as behind:
        for k in range(100):
            behind.submit(done.append, k)
        behind.catch_up()
        assert done == list(range(100))


def test_no_more_parts_wait_than_may() -> None:
    go, begun = threading.Event(), []
    with Behind(2) as behind:

        def work(k: int) -> None:
            begun.append(k)
            go.wait(10)

        behind.submit(work, 0)
        behind.submit(work, 1)
        third = threading.Thread(target=behind.submit, args=(work, 2))
        third.start()
        third.join(0.1)
        assert third.is_alive()  # until the first is done
        go.set()
        third.join(10)
        assert not third.is_alive()
        behind.catch_up()
    assert begun == [0, 1, 2]


def test_what_a_part_raises_is_raised_by_what_comes_next() -> None:
    def fail(_: int) -> None:
        raise ValueError("part")

    with Behind(1) as behind:
        behind.submit(fail, 0)
        with pytest.raises(ValueError, match="part"):
            behind.catch_up()
        behind.submit(fail, 1)
        with pytest.raises(ValueError, match="part"):
            behind.submit(print, 2)


def test_leaving_gives_up_what_has_not_begun() -> None:
    go, done = threading.Event(), []
    with Behind(5) as behind:
        behind.submit(lambda _: go.wait(10), 0)
        for k in range(3):
            behind.submit(done.append, k)
        threading.Timer(0.05, go.set).start()
    assert done == []
