"""The bench: how it is, and every lamp off."""

from pydantic import TypeAdapter

from service.api.answers.bench import BenchAnswer, DeviceAnswer, LampsOff
from service.client.link import Link

_DEVICES = TypeAdapter(tuple[DeviceAnswer, ...])


class Bench:
    """`/v1/bench`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def get(self) -> BenchAnswer:
        """Say what the bench does and who has it; no device is asked for that."""
        return self._link.get(BenchAnswer, "/v1/bench")

    def look(self) -> tuple[DeviceAnswer, ...]:
        """Ask every device how it is, while nobody else has the bench."""
        return _DEVICES.validate_json(self._link.ask("POST", "/v1/bench/look", repeatable=True))

    def safe_off(self) -> LampsOff:
        """Abort what runs, switch every lamp off and read it back, whoever has the bench.

        Queued runs wait from then on until `release`, or until somebody submits or resumes a run.
        Software is no interlock: where light can harm, a switch must be within reach.
        """
        return self._link.post(LampsOff, "/v1/safe-off", repeatable=True)

    def release(self) -> BenchAnswer:
        """Let queued runs begin again after safe-off, whoever pressed it."""
        return self._link.post(BenchAnswer, "/v1/bench/release", repeatable=True)
