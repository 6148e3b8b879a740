"""The signatures of all shapes of all effects, on both cores where that pays."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.signature import Signature, signature
from calib.diagnosis.simulation.response import Responder

THREADS = 2
WORTH_THREADS = 100_000
"""Samples of one simulation from which on arrays, and not the interpreter, take the time."""


def all_signatures(
    effects: Sequence[Sequence[Shape]],
    evidence: Evidence,
    responder: Responder,
    progress: Callable[[float], None],
) -> tuple[Signature, ...]:
    """Return the signatures of `effects`, all shapes of each, in their order."""
    total, done = sum(map(len, effects)), 0

    def told(shapes: Sequence[Shape]) -> list[Signature]:
        nonlocal done
        found: list[Signature] = []
        for shape in shapes:
            # Shapes of one effect are about as strong as each other.
            start = found[-1].strength if found else 1.0
            one = signature(shape, evidence, responder, start)
            found += [] if one is None else [one]
            done += 1
            progress(done / total)
        return found

    per_run = responder.drawing.n_lines * evidence.n_blocks * evidence.sensor.n_pixels
    if per_run < WORTH_THREADS:
        every = [told(shapes) for shapes in effects]
    else:
        evidence.point(evidence.observed())  # what all share is worked out once
        with ThreadPoolExecutor(THREADS) as pool:
            every = list(pool.map(told, effects))
    return tuple(one for found in every for one in found)
