"""Coefficient sets that cannot be used, and frames that they are not for."""
# ruff: noqa: E501 - a table is read by rows

import numpy as np

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import (
    altered_array,
    attribute,
    cut,
    frames,
    replaced,
    several,
    written,
)

APPLY = "apply set.h5 rec --out out.h5"
TOML = "rec/recording.toml"


CASES = (
    Case("coefficient set not found", "apply nowhere.h5 rec --out out.h5", "not-found", ("nowhere.h5",), "give the path"),
    Case("coefficient set truncated", APPLY, "not-a-coefficient-set", ("set.h5",), "calibrate again", cut("set.h5", 0.5)),
    Case("coefficient set empty", APPLY, "not-a-coefficient-set", ("set.h5",), "calibrate again", cut("set.h5", 0)),
    Case("text in place of a coefficient set", APPLY, "not-a-coefficient-set", ("set.h5",), "calibrate again", written("set.h5", "text " * 200)),
    Case("a recording in place of a coefficient set", "apply rec.h5 rec --out out.h5", "not-a-coefficient-set", ("rec.h5",), "calibrate again"),
    Case("a folder in place of a coefficient set", "apply rec rec.h5 --out out.h5", "not-found", ("rec",), "give the path"),
    Case("coefficient set altered", APPLY, "altered", ("set.h5",), "use the original", altered_array("set.h5", "slope")),
    Case("coefficient set under another id", APPLY, "altered", ("set.h5",), "use the original", attribute("set.h5", "id", "0" * 64)),
    Case("set of another camera", APPLY, "set-mismatch", ("rec", "serial", "'D0001'", "'D0002'"), "take the set that matches", replaced(TOML, "D0001", "D0002")),
    Case("set of another gain", APPLY, "set-mismatch", ("rec", "gain_db"), "take the set that matches", replaced(TOML, "gain_db = 0.0", "gain_db = 6.0")),
    Case("set of another bit depth", APPLY, "set-mismatch", ("rec", "bit_depth"), "take the set that matches", replaced(TOML, "bit_depth = 12", "bit_depth = 14")),
    Case("set of other columns", APPLY, "wrong-columns", ("rec", "64 columns", "32"), "same region", several(frames(lambda dn: dn[:, :32].copy()), replaced(TOML, "columns = 64", "columns = 32"))),
    Case("lines of an area sensor", APPLY, "area-sensor", ("rec",), "give a recording of a line sensor", several(frames(lambda dn: dn.reshape(16, 4, 64)), replaced(TOML, "columns = 64", "columns = 64\nrows = 4"), lambda folder: (folder / "rec/conditions.csv").write_text((folder / "rec/conditions.csv").read_text().replace(",64,", ",16,")))),
    Case("a block that is not there", f"{APPLY} --block 042", "no-such-block", ("rec", "042"), "it has 000, 001"),
    Case("bare lines without their exposure", "apply set.h5 rec/frames/004.npy --out out.h5", "exposure-missing", ("004.npy",), "give --exposure-us"),
    Case("bare lines of exposure zero", "apply set.h5 rec/frames/004.npy --exposure-us 0 --out out.h5", "bad-exposure", ("--exposure-us",), "above 0"),
    Case("bare lines of an infinite exposure", "apply set.h5 rec/frames/004.npy --exposure-us inf --out out.h5", "bad-exposure", ("--exposure-us",), "above 0"),
    Case("an exposure given for a recording that states its own", f"{APPLY} --exposure-us 40", "exposure-known", ("rec",), "leave --exposure-us out"),
    Case("bare lines not found", "apply set.h5 nowhere.npy --exposure-us 40 --out out.h5", "not-found", ("nowhere.npy",), "name a file"),
    Case("bare lines truncated", "apply set.h5 rec/frames/004.npy --exposure-us 40 --out out.h5", "frames-truncated", ("004.npy",), "copy it again", cut("rec/frames/004.npy", 0.6)),
    Case("bare lines of floating-point numbers", "apply set.h5 rec/frames/004.npy --exposure-us 40 --out out.h5", "wrong-shape", ("004.npy", "float64"), "give lines of uint8 or uint16", frames(lambda dn: dn.astype(float), "004")),
    Case("bare lines of other columns", "apply set.h5 rec/frames/004.npy --exposure-us 40 --out out.h5", "wrong-columns", ("004.npy", "64 columns", "63"), "same region", frames(lambda dn: dn[:, 1:].copy(), "004")),
    Case("bare lines above full scale", "apply set.h5 rec/frames/004.npy --exposure-us 40 --out out.h5", "code-above-full-scale", ("004.npy", "65535"), "correct bit_depth", frames(lambda dn: np.full_like(dn, 65535), "004")),
    Case("bare lines, none", "apply set.h5 rec/frames/004.npy --exposure-us 40 --out out.h5", "wrong-shape", ("004.npy", "(0, 64)"), "give lines", frames(lambda dn: dn[:0].copy(), "004")),
    Case("lines in a format that is not read", "apply set.h5 lines.png --exposure-us 40 --out out.h5", "exposure-known", ("lines.png", ".npy"), "leave --exposure-us out", written("lines.png", "PNG")),
    Case("a window that lets more through than there is", f"{APPLY} --transmittance 1.2 0.01", "transmittance-out-of-range", ("transmittance is 1.2",), "at most 1"),
    Case("lines of a folder above full scale", APPLY, "code-above-full-scale", ("004.npy", "4096"), "correct bit_depth", frames(lambda dn: np.full_like(dn, 4096), "004")),
    Case("frames altered on the way", "apply set.h5 rec.h5 --out out.h5", "crc-mismatch", ("block 004", "rec.h5"), "from a copy", altered_array("rec.h5", "frames")),
    Case("an id that no store knows", "apply 0123456789abcdef rec --out out.h5", "not-found", ("0123456789ab",), "list them"),
)  # fmt: skip
