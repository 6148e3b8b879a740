"""The file that holds corrected lines: HDF5, written under a temporary name.

/                     attributes: what the lines were corrected with, see `set_metadata`
/blocks/<block>/      attributes: exposure_us, kind, notes, flags (those of all samples)
    radiance          float32 (n_lines, n_columns)
    std               float32, the same shape, unless not asked for
    flags             uint8, bits of `calib.radiometric.correction.flags.Flag`
/columns/<exposure>/  what splits `std` into its parts, float64 (n_columns,): dark_dn, scale, v0,
                      v1, v2, noise_dn2 of `calib.radiometric.correction.apply_terms.ColumnTerms`
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py

from calib.closing import Closing
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.flags import Flag
from calib.radiometric.correction.radiance_lines import Radiance
from calib.recording.durable import disk_errors, in_new_parents, partial_path, refuse_existing, sync
from calib.recording.header import Block
from calib.recording.unfailing_file import UnfailingFile

_LAYERS = ("radiance", "std", "flags")


class RadianceFile(Closing):
    """Takes lines block by block; gets its name by `finish`, and vanishes without it.

    One chunk of each dataset holds the lines of one append.
    """

    def __init__(self, path: Path, *, std: bool) -> None:
        """Open a temporary file beside `path`; InputError `output-exists` where `path` is there."""
        refuse_existing(path)
        self._path = path
        self._partial = partial_path(path)
        self._std = std
        self._block: h5py.Group | None = None
        with disk_errors(path):
            self._disk = UnfailingFile(self._partial)
            self._file = h5py.File(self._disk, "w")

    def close(self) -> None:
        """Remove what was not finished."""
        self._file.close()
        self._disk.close()
        self._partial.unlink(missing_ok=True)

    def set_metadata(self, attributes: dict[str, Any]) -> None:
        """Write attributes of the whole file, and what each bit of a flag means."""
        with disk_errors(self._path):
            self._file.attrs.update(attributes)
            for flag in Flag:
                self._file.attrs[f"flag_{str(flag.name).lower()}"] = int(flag)

    def begin_block(self, block: Block, correction: Correction) -> None:
        """Start a block; lines that follow belong to it."""
        terms = correction.terms
        with disk_errors(self._path):
            self._block = self._file.create_group(f"blocks/{block.block}")
            self._block.attrs["kind"] = block.kind
            self._block.attrs["exposure_us"] = terms.exposure_us
            self._block.attrs["notes"] = "\n".join(correction.notes)
            self._block.attrs["flags"] = int(correction.flags)
            columns = self._file.require_group("columns")
            name = f"{terms.exposure_us:g}"
            if name not in columns:
                group = columns.create_group(name)
                for each in ("dark_dn", "scale", "v0", "v1", "v2", "noise_dn2"):
                    group.create_dataset(each, data=getattr(terms, each))

    def append(self, lines: Radiance) -> None:
        """Add lines to the block that was begun."""
        if self._block is None:
            msg = "begin_block comes before append"
            raise RuntimeError(msg)
        with disk_errors(self._path):
            for name in _LAYERS if self._std else ("radiance", "flags"):
                layer = getattr(lines, name)
                if name in self._block:
                    dataset = self._block[name]
                    first = len(dataset)
                    dataset.resize(first + len(layer), axis=0)
                    dataset[first:] = layer
                else:
                    self._block.create_dataset(
                        name, data=layer, maxshape=(None, layer.shape[1]), chunks=layer.shape
                    )
            self._disk.check()

    def finish(self) -> None:
        """Bring the file to the disk and give it its name."""
        with disk_errors(self._path):
            self._file.close()
            self._disk.check()
            sync(self._partial)
            self._partial.replace(self._path)
            sync(self._path.parent)


@contextmanager
def writing(path: Path, *, std: bool) -> Iterator[RadianceFile]:
    """Give a file that gets its name when all went well."""
    with in_new_parents(path), RadianceFile(path, std=std) as file:
        yield file
        file.finish()
