"""Radiance on its way out: an .npz, written while it is computed, in constant memory."""

import zipfile
from collections.abc import Iterator
from typing import Any, Literal

import numpy as np

from calib.radiometric.correction.apply import Correction
from service.api.raw_lines import UploadedLines
from service.api.sink import Sink
from service.store.plain_json import dumps

Layer = Literal["radiance", "std", "flags"]

_STRETCH_BYTES = 1 << 21


def radiance_npz(
    correction: Correction, lines: UploadedLines, notes: tuple[str, ...]
) -> Iterator[bytes]:
    """Yield the bytes of an .npz with `radiance`, `std`, `flags` and a `notes.json`.

    The lines are corrected once per layer: that costs less than keeping the others meanwhile.
    """
    sink = Sink()
    coefficients = correction.coefficients
    about: dict[str, Any] = {
        "coefficient_set": coefficients.id,
        "radiance_unit": coefficients.radiance_unit,
        "exposure_us": correction.terms.exposure_us,
        "notes": notes,
    }
    layers: tuple[Layer, ...] = ("radiance", "std", "flags")
    with lines.file:
        with zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED) as archive:
            archive.writestr("notes.json", dumps(about))
            for layer in layers:
                yield from _layer(archive, sink, layer, correction, lines)
        yield sink.fetch()


def _layer(
    archive: zipfile.ZipFile,
    sink: Sink,
    layer: Layer,
    correction: Correction,
    lines: UploadedLines,
) -> Iterator[bytes]:
    header = {
        "descr": "|u1" if layer == "flags" else "<f4",
        "fortran_order": False,
        "shape": (lines.n_lines, lines.n_columns),
    }
    n_lines = max(1, _STRETCH_BYTES // (4 * lines.n_columns))
    with archive.open(f"{layer}.npy", "w", force_zip64=True) as member:
        np.lib.format.write_array_header_1_0(member, header)
        for dn in lines.stretches(n_lines):
            found = getattr(correction.lines(dn, std=layer == "std"), layer)
            member.write(found.astype(header["descr"], copy=False).tobytes())
            yield sink.fetch()
