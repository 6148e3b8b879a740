"""HDF5 files from outside: none may reach for other files."""

from pathlib import Path

import h5py

from calib.errors import InputError


def check_self_contained(path: Path) -> None:
    """Raise InputError `unsafe-file` where an HDF5 file refers to another one.

    External links, external storage and virtual datasets make a reader open whatever path
    stands in the file.
    """
    try:
        with h5py.File(path, "r") as file:
            _check(file, path)
    except (OSError, RuntimeError, ValueError) as error:
        msg = f"{path.name} cannot be read as HDF5: export it again"
        raise InputError(msg, code="not-a-recording") from error


def _check(group: h5py.Group, path: Path) -> None:
    for name in group:
        link = group.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            raise _unsafe(path, name)
        item = group[name]
        if isinstance(item, h5py.Group):
            _check(item, path)
        elif isinstance(item, h5py.Dataset) and (item.external or item.is_virtual):
            raise _unsafe(path, name)


def _unsafe(path: Path, name: str) -> InputError:
    msg = f"{path.name} refers to other files ({name}); export the recording and send that"
    return InputError(msg, code="unsafe-file")
