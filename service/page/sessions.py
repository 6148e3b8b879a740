"""Which key a browser showed: kept in this process's memory alone, and named by a cookie."""

import hashlib
import secrets
import threading
import time

COOKIE = "darkflat-session"
LASTS_S = 12 * 3600.0
"""A working day; then the key is asked for again."""
_MOST = 1000


class Sessions:
    """Thread-safe. Holds digests of the tokens: what is in memory opens no other session."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._keys: dict[str, tuple[str, float]] = {}

    def begin(self, key: str) -> str:
        """Remember `key`; return the token that the browser keeps as a cookie."""
        token = secrets.token_urlsafe(32)
        with self._lock:
            self._forget_old()
            self._keys[_digest(token)] = (key, time.monotonic())
        return token

    def key(self, token: str | None) -> str | None:
        """Return the key of a session; None where it is over, or never was."""
        if token is None:
            return None
        with self._lock:
            key, began_s = self._keys.get(_digest(token), ("", float("-inf")))
        return key if time.monotonic() - began_s < LASTS_S else None

    def end(self, token: str | None) -> None:
        """Forget a session."""
        if token is not None:
            with self._lock:
                self._keys.pop(_digest(token), None)

    def _forget_old(self) -> None:
        now_s = time.monotonic()
        for digest, (_, began_s) in tuple(self._keys.items()):
            if now_s - began_s >= LASTS_S or len(self._keys) >= _MOST:
                del self._keys[digest]


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()
