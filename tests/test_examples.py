"""Every example runs and draws its pictures of the gallery."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GALLERY = ROOT / "docs" / "gallery"
FEWER = {"agcam": ("--sensors", "1"), "led_pinhole": ("--runs", "2")}
"""Repetitions, for the numbers of a page: one runs as all do, and two have a scatter."""


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda p: p.stem)
def test_an_example_draws_its_pictures(example: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, example, "--out", tmp_path, *FEWER.get(example.stem, ())],
        cwd=ROOT, capture_output=True, text=True, check=False,
        env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    drawn = sorted(p.name for p in tmp_path.iterdir())
    assert drawn
    assert all((GALLERY / name).exists() for name in drawn), f"not in the gallery: {drawn}"


def test_every_picture_of_the_gallery_is_shown_on_a_page() -> None:
    pages = "".join(p.read_text("utf-8") for p in (ROOT / "docs").rglob("*.md"))
    pages += (ROOT / "README.md").read_text("utf-8")
    unseen = [p.name for p in GALLERY.glob("*.png") if p.name not in pages]
    assert unseen == []
