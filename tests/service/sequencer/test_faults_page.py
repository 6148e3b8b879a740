"""docs/faults.md names only tests and codes that are there, and leaves no injected fault out."""

import ast
import re
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[2]
ROOT = TESTS.parent
ROWS = re.findall(
    r"^\| (?!fault|---)(.+?) \| (.*?) \| (.*?) \| (.+) \|$",
    (ROOT / "docs" / "faults.md").read_text(encoding="utf-8"),
    re.MULTILINE,
)
NAMED = sorted({found for row in ROWS for found in re.findall(r"`([\w/]+\.py)::(\w+)`", row[3])})
CODES = sorted({code for row in ROWS for code in re.findall(r"`([a-z-]+)`", row[1])})
IN_THE_MIDDLE = ("test_camera_faults.py", "test_line_faults.py")


def names_of(path: Path) -> set[str]:
    """Return the tests, classes and tables of a file."""
    names = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names |= {target.id for target in targets if isinstance(target, ast.Name)}
    return names


def injected_in(path: Path) -> set[str]:
    """Return every test of a file, or the table of the faults that it injects."""
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            tables = re.findall(r"\b[A-Z_]{4,}\b", " ".join(map(ast.dump, node.decorator_list)))
            found |= set(tables) or {node.name}
    return found


def test_every_row_names_its_test():
    assert len(ROWS) > 40
    assert all(re.search(r"\.py::\w+`", row[3]) for row in ROWS)


@pytest.mark.parametrize(("path", "name"), NAMED, ids="::".join)
def test_every_test_that_the_page_names_is_there(path: str, name: str):
    assert name in names_of(TESTS / path)


def test_every_code_that_the_page_names_is_raised_somewhere():
    sources = [p for part in ("calib", "drivers", "service") for p in (ROOT / part).rglob("*.py")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in sources)
    assert [code for code in CODES if f'"{code}"' not in text] == []


@pytest.mark.parametrize("name", IN_THE_MIDDLE)
def test_no_fault_that_is_injected_in_the_middle_of_a_sweep_is_missing_on_the_page(name: str):
    on_the_page = {named for path, named in NAMED if path.endswith(f"/{name}")}
    assert injected_in(Path(__file__).with_name(name)) <= on_the_page
