"""Runs: queued, followed over lost connections, held and ended."""

import time
import uuid
from collections.abc import Iterator, Mapping
from typing import Any

import httpx2
from pydantic import TypeAdapter

from service.api.answers.run import EventAnswer, PlanAnswer, RunAnswer, RunPage
from service.client.endings import FINAL, succeeded
from service.client.errors import ServiceLostError
from service.client.link import Link

_AGAIN_S = 0.2
_EVENTS = TypeAdapter(tuple[EventAnswer, ...])


class Runs:
    """`/v1/runs`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def validate(self, plan: Mapping[str, Any]) -> PlanAnswer:
        """Return what a plan stands for and how long it takes; nothing moves."""
        return self._link.post(
            PlanAnswer, "/v1/runs", dict(plan), params={"validate": True}, repeatable=True
        )

    def start(self, plan: Mapping[str, Any], *, idempotency_key: str | None = None) -> RunAnswer:
        """Queue a plan, once, however often the connection breaks.

        Args:
            plan: As in a plan file.
            idempotency_key: The same key gives the same run, also after this program was started
                anew; None: one of its own.
        """
        headers = {"Idempotency-Key": idempotency_key or uuid.uuid4().hex}
        return self._link.post(RunAnswer, "/v1/runs", dict(plan), headers=headers, repeatable=True)

    def get(self, run_id: str) -> RunAnswer:
        """Return a run as it is now."""
        return self._link.get(RunAnswer, f"/v1/runs/{run_id}")

    def all(self, *, state: str | None = None) -> Iterator[RunAnswer]:
        """Yield every run, newest first."""
        return self._link.pages(RunPage, "/v1/runs", state=state)

    def pause(self, run_id: str) -> RunAnswer:
        """Hold a run."""
        return self._command(run_id, "pause")

    def resume(self, run_id: str) -> RunAnswer:
        """Let it go on, or queue it again where it was ended before it was whole."""
        return self._command(run_id, "resume")

    def abort(self, run_id: str) -> RunAnswer:
        """End it."""
        return self._command(run_id, "abort")

    def follow(self, run_id: str, *, after: int = 0) -> Iterator[EventAnswer]:
        """Yield each event once, in order and without gaps, until the run's state is final.

        Where the connection breaks, or the service is away, the stream is asked for again from
        the last event that came.

        Args:
            run_id: The run.
            after: The number of the last event that is known already.

        Raises:
            ServiceLostError: The service was away for longer than the client's patience.
        """
        seen_s = time.monotonic()
        while True:
            try:
                for event in self._stream(run_id, after):
                    after, seen_s = event.number, time.monotonic()
                    yield event
                    seen_s = time.monotonic()  # what the caller does meanwhile is no silence
                # A service that stops ends its streams, too.
                if self.get(run_id).state in FINAL:
                    return
            except httpx2.TransportError as error:
                if time.monotonic() - seen_s > self._link.patience_s:
                    raise ServiceLostError(self._link.url, error) from error
            time.sleep(_AGAIN_S)

    def journal(self, run_id: str, *, after: int = 0) -> Iterator[EventAnswer]:
        """Yield what a run has said so far, behind the event `after`; waits for nothing."""
        place = f"/v1/runs/{run_id}/journal"
        while True:
            told = self._link.ask("GET", place, params={"after": after}, repeatable=True)
            events = _EVENTS.validate_json(told)
            if not events:
                return
            yield from events
            after = events[-1].number

    def wait(self, run_id: str) -> RunAnswer:
        """Return the run once it has succeeded.

        Raises:
            WorkFailedError: It came to another end; the code is the run's.
        """
        for _ in self.follow(run_id):
            pass
        return succeeded("run", self.get(run_id))

    def _command(self, run_id: str, command: str) -> RunAnswer:
        return self._link.post(RunAnswer, f"/v1/runs/{run_id}/{command}", repeatable=True)

    def _stream(self, run_id: str, after: int) -> Iterator[EventAnswer]:
        headers = {"Accept": "text/event-stream", "Last-Event-ID": str(after)}
        place = f"/v1/runs/{run_id}/events"
        with self._link.stream("GET", place, headers=headers) as response:
            for sent in httpx2.EventSource(response):
                yield EventAnswer.model_validate_json(sent.data)
