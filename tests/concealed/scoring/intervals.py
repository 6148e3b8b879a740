"""Shares with their exact binomial intervals."""

from collections.abc import Iterable
from dataclasses import dataclass

from scipy.stats import beta


@dataclass(frozen=True)
class Share:
    """`hits` of `n`, with the Clopper-Pearson interval of 95 %.

    Source: Clopper and Pearson, Biometrika 26 (1934) 404.
    """

    hits: int
    n: int

    @classmethod
    def of(cls, each: Iterable[bool]) -> "Share":
        """Count them."""
        every = list(each)
        return cls(sum(every), len(every))

    @property
    def value(self) -> float:
        """Hits over n; NaN of none."""
        return self.hits / self.n if self.n else float("nan")

    @property
    def low(self) -> float:
        """The interval's lower end."""
        return float(beta.ppf(0.025, self.hits, self.n - self.hits + 1)) if self.hits else 0.0

    @property
    def high(self) -> float:
        """The interval's upper end."""
        if self.hits == self.n:
            return 1.0
        return float(beta.ppf(0.975, self.hits + 1, self.n - self.hits))

    def __str__(self) -> str:
        """In per cent.

        >>> str(Share(9, 10))
        '90.0 % (55.5-99.7, 9/10)'
        """
        if not self.n:
            return "-"
        low, high = 100 * self.low, 100 * self.high
        return f"{100 * self.value:.1f} % ({low:.1f}-{high:.1f}, {self.hits}/{self.n})"
