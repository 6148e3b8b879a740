"""Random numbers of the tests: others with every change, the same for one state of the code.

A test of coverage fails by chance now and then, and what fails must fail again when somebody looks.
`default_rng()` without a seed therefore follows from the files that git holds, docs apart, from the
test's name and from how often it was called in that test. A changed checkout draws anew each time.

    DARKFLAT_DRAWS=WORD pytest ...      # draws as the run did that printed WORD
"""

import os
import secrets
import subprocess
from collections import Counter
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

VARIABLE = "DARKFLAT_DRAWS"
# What git holds at the top that no test draws from.
PROSE = ("\tdocs", ".md")
seeded = np.random.default_rng
called: Counter[str] = Counter()


def word_of(checkout: Path) -> str:
    """Return the name of what git holds, or a word of chance where the checkout differs from it."""

    def git(*asked: str) -> str:
        command = ["git", "-C", str(checkout), *asked]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        if not git("status", "--porcelain", "--untracked-files=no"):
            held = git("ls-tree", "--full-tree", "HEAD").splitlines()
            code = "\n".join(line for line in held if not line.endswith(PROSE))
            return sha256(code.encode()).hexdigest()[:12]
    except (OSError, subprocess.CalledProcessError):
        pass
    return secrets.token_hex(6)


def drawn(seed: Any = None) -> np.random.Generator:
    """Return a generator as NumPy does; without a seed, that of this call in this test."""
    if seed is not None:
        return seeded(seed)
    test = os.environ.get("PYTEST_CURRENT_TEST", "collection").rpartition(" (")[0]
    called[test] += 1
    return shared(f"{called[test]} {test}")


def shared(what: str) -> np.random.Generator:
    """Return the generator for what tests of several files share, whichever of them asks first."""
    key = f"{os.environ.get(VARIABLE, secrets.token_hex(6))} {what}"
    return seeded(int.from_bytes(sha256(key.encode()).digest()))


def settle() -> None:
    """Let all tests of this process draw from here; workers inherit the word."""
    if VARIABLE not in os.environ:
        os.environ[VARIABLE] = word_of(Path(__file__).parent)
    pytest.MonkeyPatch().setattr(np.random, "default_rng", drawn)
