"""What the receiving end counted: packets resent, ignored, missing; frames failed; underruns."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from drivers.aravis.gi_types import GiStream


@dataclass(frozen=True)
class StreamReport:
    """Counters of one or several acquisitions, by the names that Aravis gives them.

    `GvStream.get_statistics` shadows `Stream.get_statistics` in Python, so that the two counts it
    would give are not those one expects; the named infos are unmistakable.
    """

    counts: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    @classmethod
    def read(cls, stream: GiStream) -> "StreamReport":
        """Return what `stream` has counted so far."""
        return cls(MappingProxyType(dict(_infos(stream))))

    def __add__(self, other: "StreamReport") -> "StreamReport":
        total = Counter[str](dict(self.counts))
        total.update(dict(other.counts))
        return StreamReport(MappingProxyType(dict(total)))

    @property
    def underruns(self) -> int:
        """Packets that found no buffer free: the consumer was too slow, not the link."""
        return self._count("n_underruns")

    @property
    def missing_packets(self) -> int:
        """Packets that never came, after all resend requests."""
        return self._count("n_missing_packets")

    @property
    def resend_requests(self) -> int:
        """Packets asked for again."""
        return self._count("n_resend_requests")

    @property
    def failures(self) -> int:
        """Frames that ended in any other way than whole."""
        return self._count("n_failures")

    def _count(self, name: str) -> int:
        return int(self.counts.get(name, 0))


def _infos(stream: GiStream) -> list[tuple[str, float]]:
    infos: list[tuple[str, float]] = []
    for index in range(stream.get_n_infos()):
        is_count = getattr(stream.get_info_type(index), "name", "") == "guint64"
        read = stream.get_info_uint64 if is_count else stream.get_info_double
        infos.append((stream.get_info_name(index), read(index)))
    return infos
