"""A file of arrays and metadata that is named by its content.

The name is the SHA-256 over the arrays and the canonical metadata, not over the HDF5 bytes,
which differ between writers of the same content.
"""

import hashlib
import json
import os
import tempfile
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.recording.durable import DiskFullError, is_disk_full
from calib.recording.unfailing_file import UnfailingFile

Arrays = Mapping[str, NDArray[Any]]
METADATA = "metadata_json"


def canonical_json(metadata: Mapping[str, Any]) -> str:
    """Return the one spelling of `metadata`: sorted keys, no spaces, shortest floats, no NaN."""
    return json.dumps(
        metadata, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True
    )


def canonical_array(array: NDArray[Any]) -> NDArray[Any]:
    """Return a little-endian, contiguous copy with one kind of NaN and no negative zero."""
    little = np.array(array, dtype=array.dtype.newbyteorder("<"), order="C", copy=True)
    if little.dtype.kind == "f":
        little[np.isnan(little)] = np.nan
        little += 0.0
    return little


def content_id(arrays: Arrays, metadata: Mapping[str, Any]) -> str:
    """Return the SHA-256 (64 hexadecimal digits) over arrays and metadata."""
    digest = hashlib.sha256(canonical_json(metadata).encode("ascii"))
    for name in sorted(arrays):
        array = canonical_array(arrays[name])
        digest.update(f"\n{name} {array.dtype.str} {array.shape}\n".encode("ascii"))
        digest.update(array.tobytes())
    return digest.hexdigest()


def write(path: Path, arrays: Arrays, metadata: Mapping[str, Any]) -> str:
    """Write both to `path`, whole or not at all, and return the content's id.

    Raises:
        InputError: `cannot-write` where the folder does not take the file.
        DiskFullError: `disk-full`.
    """
    identity = content_id(arrays, metadata)
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        os.close(handle)
        with closing(UnfailingFile(Path(temporary))) as disk:
            with h5py.File(disk, "w") as file:
                _fill(file, identity, arrays, metadata)
            disk.check()
        _settle(Path(temporary), path)
    except OSError as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        if is_disk_full(error):
            raise DiskFullError(path) from error
        message = f"{path} cannot be written ({error.strerror or error}): choose another folder."
        raise InputError(message, code="cannot-write") from error
    return identity


def _fill(file: h5py.File, identity: str, arrays: Arrays, metadata: Mapping[str, Any]) -> None:
    file.attrs["id"] = identity
    for key, value in metadata.items():
        if isinstance(value, str | int | float):
            file.attrs[key] = value
    for name in sorted(arrays):
        file.create_dataset(name, data=canonical_array(arrays[name]))
    file.create_dataset(METADATA, data=canonical_json(metadata))


def _settle(temporary: Path, path: Path) -> None:
    """Bring the temporary file to the disk, then under its name."""
    with temporary.open("rb+") as file:
        os.fsync(file.fileno())
    umask = os.umask(0)
    os.umask(umask)
    temporary.chmod(0o666 & ~umask)
    temporary.replace(path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def read(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """Return arrays and metadata of a file whose content still bears its id.

    Raises:
        InputError: `not-found`, `not-a-coefficient-set` or `altered`.
    """
    if not path.is_file():
        raise InputError(f"{path} does not exist: give the path of a set.", code="not-found")
    try:
        with h5py.File(path, "r") as file:
            stated = {str(key): _plain(value) for key, value in file.attrs.items()}
            metadata = dict(json.loads(file[METADATA].asstr()[()]))
            arrays = {str(name): np.asarray(file[name][()]) for name in file if name != METADATA}
    except PermissionError as error:
        message = f"{path} cannot be read (Permission denied): get the right to read it."
        raise InputError(message, code="not-a-coefficient-set") from error
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        message = f"{path} is not a coefficient set, or is damaged: calibrate again."
        raise InputError(message, code="not-a-coefficient-set") from error
    same = all(metadata.get(key) == value for key, value in stated.items() if key != "id")
    if not same or content_id(arrays, metadata) != stated.get("id"):
        message = f"{path} does not hold what its id names, it was altered: use the original file."
        raise InputError(message, code="altered")
    return arrays, metadata


def _plain(value: Any) -> Any:
    """Return an HDF5 attribute as the Python value that JSON gives back."""
    return value.item() if isinstance(value, np.generic) else value
