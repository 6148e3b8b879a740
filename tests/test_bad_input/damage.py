"""Ways in which files go bad; each gives a `Damage`."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from tests.test_bad_input.case import Damage


def replaced(name: str, old: str, new: str) -> Damage:
    """Put `new` where `old` stands first."""

    def damage(folder: Path) -> None:
        before = (folder / name).read_text(encoding="utf-8")
        assert old in before, f"{old!r} is not in {name}"
        (folder / name).write_text(before.replace(old, new, 1), encoding="utf-8")

    return damage


def value(name: str, key: str, toml: str) -> Damage:
    """Give `key` another value."""

    def damage(folder: Path) -> None:
        before = (folder / name).read_text(encoding="utf-8")
        after, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {toml}", before)
        assert count == 1, f"{key} stands {count} times in {name}"
        (folder / name).write_text(after, encoding="utf-8")

    return damage


def written(name: str, content: bytes | str) -> Damage:
    """Have `content` there instead, in whatever folder it needs."""

    def damage(folder: Path) -> None:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)

    return damage


def cut(name: str, share: float) -> Damage:
    """Keep the first `share` of the bytes."""

    def damage(folder: Path) -> None:
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[: int(share * len(content))])

    return damage


def removed(name: str) -> Damage:
    """Lose a file or a folder."""

    def damage(folder: Path) -> None:
        path = folder / name
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    return damage


def renamed(old: str, new: str) -> Damage:
    """Give a file another name."""
    return lambda folder: (folder / old).rename(folder / new)


def folder_instead(name: str) -> Damage:
    """Have an empty folder where a file is expected."""

    def damage(folder: Path) -> None:
        (folder / name).unlink(missing_ok=True)
        (folder / name).mkdir()

    return damage


def frames(change: Callable[[NDArray[np.uint16]], NDArray[np.generic]], *blocks: str) -> Damage:
    """Change the frames of these blocks of the folder `rec`; of all where none is named."""

    def damage(folder: Path) -> None:
        names = blocks or [path.stem for path in (folder / "rec/frames").iterdir()]
        for block in names:
            path = folder / f"rec/frames/{block}.npy"
            np.save(path, change(np.load(path)))

    return damage


def images(
    change: Callable[[NDArray[np.floating]], NDArray[np.generic]], *paths: str, of: str = "scan"
) -> Damage:
    """Change these images of the folder `scan` (or another); all of them where none is named."""

    def damage(folder: Path) -> None:
        for path in sorted((folder / of / "frames").iterdir()):
            if not paths or path.stem in paths:
                np.save(path, change(np.load(path)))

    return damage


def rows(keep: Callable[[dict[str, str]], bool]) -> Damage:
    """Keep only these blocks of the folder `rec`, rows and frames."""

    def damage(folder: Path) -> None:
        path = folder / "rec/conditions.csv"
        head, *lines = path.read_text().splitlines()
        kept = []
        for line in lines:
            row = dict(zip(head.split(","), line.split(","), strict=True))
            if keep(row):
                kept.append(line)
            else:
                (folder / f"rec/frames/{row['block']}.npy").unlink()
        path.write_text("\n".join([head, *kept, ""]))

    return damage


def flipped_byte(name: str, at: float) -> Damage:
    """Flip the bits of one byte, at this share of the file."""

    def damage(folder: Path) -> None:
        content = bytearray((folder / name).read_bytes())
        content[int(at * len(content))] ^= 0xFF
        (folder / name).write_bytes(content)

    return damage


def altered_array(name: str, dataset: str) -> Damage:
    """Change one number of an HDF5 dataset, the file otherwise whole."""

    def damage(folder: Path) -> None:
        with h5py.File(folder / name, "r+") as file:
            values = file[dataset][()]
            values.flat[values.size // 2] += 1
            file[dataset][...] = values

    return damage


def several(*damages: Damage) -> Damage:
    """Do one damage after the other."""

    def damage(folder: Path) -> None:
        for each in damages:
            each(folder)

    return damage


def earlier_block(name: str, block: str) -> Damage:
    """Say that a block started before all others."""

    def damage(folder: Path) -> None:
        path = folder / name
        rows = [line.split(",") for line in path.read_text().splitlines()]
        at = rows[0].index("started_s")
        for row in rows:
            if row[0] == block:
                row[at] = "-1"
        path.write_text("\n".join(map(",".join, rows)) + "\n")

    return damage


def scene_named(name: str, scene: str) -> Damage:
    """Have every block name a scene."""

    def damage(folder: Path) -> None:
        path = folder / name
        head, *rows = path.read_text().splitlines()
        path.write_text("\n".join([f"{head},scene", *(f"{row},{scene}" for row in rows), ""]))

    return damage


def attribute(name: str, key: str, value: str) -> Damage:
    """Change an attribute of an HDF5 file."""

    def damage(folder: Path) -> None:
        with h5py.File(folder / name, "r+") as file:
            file.attrs[key] = value

    return damage
