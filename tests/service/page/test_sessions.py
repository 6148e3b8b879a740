"""Sessions: a token opens what its key did, for a day, in this process."""

import time

import pytest

from service.page.sessions import LASTS_S, Sessions


def test_a_token_gives_back_its_key_and_no_other_text_does() -> None:
    sessions = Sessions()
    first, second = sessions.begin("key 1"), sessions.begin("key 2")
    assert (sessions.key(first), sessions.key(second)) == ("key 1", "key 2")
    assert [sessions.key(text) for text in (None, "", first[:-1], first.swapcase())] == [None] * 4
    sessions.end(first)
    assert (sessions.key(first), sessions.key(second)) == (None, "key 2")


def test_a_session_is_over_after_a_day(monkeypatch: pytest.MonkeyPatch) -> None:
    sessions = Sessions()
    token, now_s = sessions.begin("key"), time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now_s + LASTS_S - 1.0)
    assert sessions.key(token) == "key"
    monkeypatch.setattr(time, "monotonic", lambda: now_s + LASTS_S + 1.0)
    assert sessions.key(token) is None


def test_what_is_kept_is_bounded_and_names_no_token() -> None:
    sessions = Sessions()
    tokens = [sessions.begin(str(n)) for n in range(1500)]
    assert sessions.key(tokens[-1]) == "1499"
    assert len(sessions._keys) <= 1000
    assert not set(tokens) & set(sessions._keys)
