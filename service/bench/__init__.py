"""The bench: which devices it has, opening them, and leaving them dark."""

from service.bench.bench import Bench
from service.bench.opening import open_bench
from service.bench.settings import BenchSettings

__all__ = ["Bench", "BenchSettings", "open_bench"]
