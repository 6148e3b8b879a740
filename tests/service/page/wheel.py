"""The wheel, and an environment that holds it and what it says it needs, and nothing else."""

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[3]
PACKAGES = ("calib", "drivers", "service")
WATCH = """
import os, sys

def _look(event, args):
    if event in ("open", "os.listdir", "os.scandir") and isinstance(args[0], (str, bytes)):
        path = os.path.realpath(os.fsdecode(args[0]))
        if path.startswith({root!r}) and not path.startswith({dependencies!r}):
            with open({log!r}, "a") as log:
                log.write(path + "\\n")

sys.addaudithook(_look)
"""
"""What Python runs before anything else: it writes down what is read of the source tree."""


def build(folder: Path) -> Path:
    """Build the wheel of a copy of the sources, which is removed; return where it is.

    In the sources' own folder setuptools would take in what an earlier build left there. pip
    fetches setuptools, as it does for `make setup`.
    """
    sources = folder / "sources"
    for package in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / package, sources / package, ignore=ignored)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, sources)
    _pip("wheel", "--no-deps", "--wheel-dir", str(folder), str(sources))
    shutil.rmtree(sources)
    (wheel,) = folder.glob("*.whl")
    return wheel


def install(wheel: Path, folder: Path, log: Path) -> Path:
    """Make an environment with `wheel`; return its folder of programs.

    What the wheel needs is linked into it from the environment of the tests, so that nothing else
    of that is there. What its programs read of the source tree, `log` names.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    programs = folder / "bin"
    alone = ("--no-deps", "--no-index", "--no-compile")
    _pip("--python", str(programs / "python"), "install", *alone, str(wheel))
    (packages,) = folder.glob("lib/python*/site-packages")
    (installed,) = Distribution.discover(name="darkflat", path=[str(packages)])
    for needed in _needed(installed):
        _link(needed, packages)
    dependencies = str(Path(str(distribution("numpy").locate_file(""))).resolve())
    watch = WATCH.format(root=f"{ROOT.resolve()}/", dependencies=dependencies, log=str(log))
    (packages / "sitecustomize.py").write_text(watch)
    return programs


def _needed(of: Distribution) -> Iterator[Distribution]:
    """Yield what a distribution needs, and what that does; extras only where they are named."""
    seen: set[tuple[str, frozenset[str]]] = set()
    waiting = [(of, frozenset[str]())]
    while waiting:
        one, extras = waiting.pop()
        for each in map(Requirement, one.requires or ()):
            wanted = (re.sub(r"[-_.]+", "-", each.name).lower(), frozenset(each.extras))
            holds = each.marker is None or any(
                each.marker.evaluate({"extra": extra}) for extra in extras or {""}
            )
            if holds and wanted not in seen:
                seen.add(wanted)
                found = distribution(each.name)
                waiting.append((found, wanted[1]))
                yield found


def _link(needed: Distribution, packages: Path) -> None:
    """Link what a distribution has at the top of its environment."""
    names = {file.parts[0] for file in needed.files or ()} - {"..", "__pycache__"}
    for name in names:
        target = packages / name
        if not target.exists():
            target.symlink_to(Path(str(needed.locate_file(name))))


def _pip(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "pip", "--quiet", *arguments], check=True)
