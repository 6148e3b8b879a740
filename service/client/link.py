"""The connection to the service: keys, problems, pages, and what is asked again when it breaks."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeVar

import httpx2
from pydantic import BaseModel

from calib.recording.durable import disk_errors, partial_path
from service.client.errors import ProblemError, ServiceLostError

Answer = TypeVar("Answer", bound=BaseModel)
Got = TypeVar("Got")

_AGAIN_S = 0.2
_SILENT_S = 30.0
"""The service says something at least every 15 s on a stream: longer silence is a dead line."""


class Link:
    """One pool of connections. Thread-safe.

    Attributes:
        url: Of the service.
        patience_s: How long a service that is away is waited for.
    """

    def __init__(self, url: str, *, key: str | None, patience_s: float) -> None:
        self.url = url
        self.patience_s = patience_s
        headers = {} if key is None else {"Authorization": f"Bearer {key}"}
        timeout = httpx2.Timeout(_SILENT_S, connect=5.0)
        # A proxy of the environment has no business between a control PC and its bench.
        self._http = httpx2.Client(base_url=url, headers=headers, timeout=timeout, trust_env=False)

    def get(self, kind: type[Answer], place: str, **query: Any) -> Answer:
        """Read `place`; asked again while the service is away."""
        return kind.model_validate_json(self.ask("GET", place, params=query, repeatable=True))

    def post(self, kind: type[Answer], place: str, json: Any = None, **more: Any) -> Answer:
        """Ask for something to be done; `more` as for `ask`."""
        return kind.model_validate_json(self.ask("POST", place, json=json, **more))

    def pages(self, kind: type[Answer], place: str, **query: Any) -> Iterator[Any]:
        """Yield the items of every page, newest first."""
        before: int | None = None
        while True:
            page: Any = self.get(kind, place, **query, before=before)
            yield from page.items
            before = page.next_before
            if before is None:
                return

    def ask(
        self,
        method: str,
        place: str,
        *,
        params: Mapping[str, Any] | None = None,
        json: Any = None,
        content: Iterable[bytes] | None = None,
        headers: Mapping[str, str] | None = None,
        repeatable: bool = False,
    ) -> bytes:
        """Return the body of the answer.

        Args:
            method: Of the request.
            place: Its path.
            params: Its query; what is None is left out.
            json: Its body, as JSON.
            content: Its body, piece by piece.
            headers: Beside those of every request.
            repeatable: Whether it may be asked again where the connection broke, when nobody
                knows whether the service has heard it.

        Raises:
            ProblemError: The service says no; the code is its.
            ServiceLostError: Nothing answers, for `patience_s` where `repeatable`.
        """

        def once() -> httpx2.Response:
            return self._http.request(
                method, place, params=given(params), json=json, content=content, headers=headers
            )

        response = self._patiently(once, repeatable=repeatable)
        raise_problem(response)
        return response.content

    def receive(self, into: IO[bytes], method: str, place: str, **request: Any) -> None:
        """Write an answer to `into` as it comes; errors as those of `ask`, asked once."""
        self._patiently(lambda: self._copy(into, method, place, **request), repeatable=False)

    def download(self, place: str, out: Path | str) -> Path:
        """Write what is at `place` to the file `out`, whole, or leave that as it was."""
        path = Path(out)
        partial = partial_path(path)

        def once() -> None:
            with disk_errors(path), partial.open("wb") as file:
                self._copy(file, "GET", place)

        try:
            self._patiently(once, repeatable=True)
            with disk_errors(path):
                partial.replace(path)
        finally:
            with suppress(OSError):
                partial.unlink()
        return path

    def _copy(self, into: IO[bytes], method: str, place: str, **request: Any) -> None:
        with self.stream(method, place, **request) as response:
            for chunk in response.iter_bytes():
                into.write(chunk)

    def _patiently(self, once: Callable[[], Got], *, repeatable: bool) -> Got:
        """Do it, and again where the line broke, for as long as patience lasts from then on."""
        deadline_s: float | None = None
        while True:
            try:
                return once()
            except httpx2.TransportError as error:
                now_s = time.monotonic()
                deadline_s = now_s + self.patience_s if deadline_s is None else deadline_s
                if not repeatable or now_s >= deadline_s:
                    raise ServiceLostError(self.url, error) from error
                time.sleep(_AGAIN_S)

    @contextmanager
    def stream(self, method: str, place: str, **request: Any) -> Iterator[httpx2.Response]:
        """Give an answer whose body is read as it comes; transport errors are the caller's."""
        if "params" in request:
            request["params"] = given(request["params"])
        with self._http.stream(method, place, **request) as response:
            if response.is_error:
                response.read()
            raise_problem(response)
            yield response

    def close(self) -> None:
        """Release the connections; safe to call twice."""
        self._http.close()


def raise_problem(response: httpx2.Response) -> None:
    """Raise the problem that an answer tells of; nothing for a good one."""
    if not response.is_error:
        return
    try:
        told = response.json()
    except ValueError:
        told = {}
    raise ProblemError(response.status_code, told if isinstance(told, dict) else {})


def given(params: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return what is not None: the service has a default for the rest."""
    return {name: value for name, value in (params or {}).items() if value is not None}
