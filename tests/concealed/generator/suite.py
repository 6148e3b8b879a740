"""The suite: all cases of a run, from nothing but a string and a size."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator, default_rng

from tests.concealed.generator.case import Case, Hidden
from tests.concealed.generator.catalogue import ALL, LISTED, UNLISTED
from tests.concealed.generator.mechanism import Mechanism

Content = tuple[str, tuple[Hidden, ...]]
"""A case's kind and what it hides."""


@dataclass(frozen=True)
class Size:
    """How much of everything a run holds.

    Attributes:
        rungs: Of the ladder of strengths, for each listed effect.
        repeats: Cases per effect and rung.
        foreign: Cases per shape that catalogues do not have.
        unlisted: Cases per piece of physics that no catalogue has.
    """

    rungs: int
    repeats: int
    foreign: int
    doubles: int
    triples: int
    unlisted: int
    clean: int
    most_pixels: int


FULL = Size(9, 3, 4, 160, 80, 16, 320, 500_000)
PART = Size(2, 1, 0, 8, 4, 1, 16, 150_000)
SIZES = {"full": FULL, "part": PART}


def suite(origin: str, size: Size) -> tuple[Case, ...]:
    """Return the cases of the run that `origin` (a commit's hash) names.

    Numbers are given after the cases are shuffled: they tell nothing.
    """
    rng = default_rng(_integer(origin))
    contents = list(_contents(size, rng))
    cases = []
    for number, place in enumerate(rng.permutation(len(contents))):
        kind, hidden = contents[place]
        cases.append(Case(number, kind, hidden, _integer(f"{origin} {number}"), size.most_pixels))
    return tuple(cases)


def _contents(size: Size, rng: Generator) -> Iterator[Content]:
    for name, kind in LISTED.items():
        yield from _known(name, kind, size)
        yield from _foreign(name, kind, size, rng)
    for name in UNLISTED:
        for _ in range(size.unlisted):
            yield "unlisted", (Hidden(name, "plain", rng.uniform(0.45, 1.0)),)
    for _ in range(size.doubles):
        yield "double", _several(2, rng)
    for _ in range(size.triples):
        yield "triple", _several(3, rng)
    for _ in range(size.clean):
        yield "clean", ()


def _known(name: str, kind: type[Mechanism], size: Size) -> Iterator[Content]:
    for rung in _ladder(size.rungs):
        for k in range(size.repeats):
            yield "single", (Hidden(name, kind.shapes[k % len(kind.shapes)], rung),)


def _foreign(name: str, kind: type[Mechanism], size: Size, rng: Generator) -> Iterator[Content]:
    for shape in kind.foreign:
        for _ in range(size.foreign):
            yield "foreign", (Hidden(name, shape, rng.uniform(0.55, 0.95)),)


def _ladder(n: int) -> list[float]:
    """Return `n` rungs, the last obvious, the first barely visible where there are few.

    >>> _ladder(2)
    [0.7, 1.0]
    """
    return [float(rung) for rung in np.round(np.linspace(0.0 if n > 3 else 0.7, 1.0, n), 6)]


def _several(n: int, rng: Generator) -> tuple[Hidden, ...]:
    names = rng.choice(sorted(LISTED), n, replace=False)
    return tuple(
        Hidden(str(name), str(rng.choice(ALL[name].shapes)), rng.uniform(0.6, 0.95))
        for name in names
    )


def _integer(text: str) -> int:
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big")
