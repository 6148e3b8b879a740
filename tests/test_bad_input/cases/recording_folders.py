"""Recording folders that `import` (and every command that takes REC) cannot use."""
# ruff: noqa: E501 - a table is read by rows

import numpy as np

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import (
    cut,
    earlier_block,
    folder_instead,
    frames,
    removed,
    renamed,
    replaced,
    scene_named,
    value,
    written,
)

IMPORT = "import rec --out out.h5"
CSV, TOML, NPY = "rec/conditions.csv", "rec/recording.toml", "rec/frames/001.npy"

CASES = (
    Case("folder not found", "import nowhere --out out.h5", "recording-not-found", ("nowhere",), "recording folder"),
    Case("a file instead of a folder", "import rec.h5 --out out.h5", "not-a-folder", ("rec.h5",), "name the folder"),
    Case("a folder that is empty", "import empty --out out.h5", "recording-incomplete", ("empty", "conditions.csv"), "add it", folder_instead("empty")),
    Case("frames truncated", IMPORT, "frames-truncated", ("001.npy",), "copy it again", cut(NPY, 0.6)),
    Case("frames empty", IMPORT, "frames-truncated", ("001.npy",), "copy it again", cut(NPY, 0)),
    Case("frames renamed", IMPORT, "frames-missing", ("block 001", "frames"), "put them back", renamed(NPY, "rec/frames/one.npy")),
    Case("frames of a block missing", IMPORT, "frames-missing", ("block 001", "frames"), "put them back", removed(NPY)),
    Case("frames that no row names", IMPORT, "frames-extra", ("009.npy", "conditions.csv"), "add the row", lambda folder: np.save(folder / "rec/frames/009.npy", np.zeros((64, 64), np.uint16))),
    Case("all frames missing", IMPORT, "recording-incomplete", ("rec", "frames/"), "add the one", removed("rec/frames")),
    Case("a folder in place of frames", IMPORT, "frames-unreadable", ("001.npy", "no file"), "save it again", folder_instead(NPY)),
    Case("text in place of frames", IMPORT, "frames-unreadable", ("001.npy",), "save it again", written(NPY, "not an array, though long enough to be one " * 20)),
    Case("frames of too few columns", IMPORT, "frames-wrong-shape", ("001.npy", "(64, 63)"), "correct columns", frames(lambda dn: dn[:, 1:].copy(), "001")),
    Case("a stack of images for lines", IMPORT, "frames-wrong-shape", ("001.npy", "(2, 32, 64)"), "correct columns or rows", frames(lambda dn: dn.reshape(2, 32, 64), "001")),
    Case("two lines per block where conditions.csv says 64", IMPORT, "lines-mismatch", ("001.npy", "block 001", "64"), "correct the row", frames(lambda dn: dn[:2].copy(), "001")),
    Case("frames of floating-point numbers", IMPORT, "frames-wrong-dtype", ("001.npy", "float64"), "save the raw codes", frames(lambda dn: dn.astype(np.float64), "001")),
    Case("frames of signed integers", IMPORT, "frames-wrong-dtype", ("001.npy", "int16"), "save the raw codes", frames(lambda dn: dn.astype(np.int16), "001")),
    Case("frames of 8 bits from a 12-bit camera", IMPORT, "frames-wrong-dtype", ("001.npy", "uint8"), "save the raw codes", frames(lambda dn: (dn >> 4).astype(np.uint8), "001")),
    Case("codes above full scale", IMPORT, "code-above-full-scale", ("001.npy", "4096", "4095"), "correct bit_depth", frames(lambda dn: np.full_like(dn, 4096), "001")),
    Case("bit depth too small for the codes", IMPORT, "code-above-full-scale", (".npy", "1023 of 10 bits"), "correct bit_depth", replaced(TOML, "bit_depth = 12", "bit_depth = 10")),
    Case("bit depth that no camera has", IMPORT, "header-invalid", ("recording.toml", "camera.bit_depth"), "less than or equal to 16", replaced(TOML, "bit_depth = 12", "bit_depth = 32")),
    Case("conditions.csv missing", IMPORT, "recording-incomplete", ("conditions.csv",), "add it", removed(CSV)),
    Case("conditions.csv empty", IMPORT, "conditions-missing-columns", ("conditions.csv", "exposure_us"), "leave cells empty", written(CSV, "")),
    Case("conditions.csv without rows", IMPORT, "recording-incomplete", ("conditions.csv",), "one per block", written(CSV, "block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance\n")),
    Case("conditions.csv without a column", IMPORT, "conditions-missing-columns", ("conditions.csv", "exposure_us"), "leave cells empty", replaced(CSV, "exposure_us", "exposure")),
    Case("a row of too few cells", IMPORT, "conditions-invalid", ("conditions.csv", "row 3"), "correct it", replaced(CSV, "001,flat,", "001,")),
    Case("blocks out of order", IMPORT, "conditions-out-of-order", ("conditions.csv", "block 002"), "put the blocks in the order", earlier_block(CSV, "002")),
    Case("a block twice", IMPORT, "duplicate-block", ("conditions.csv", "row 4", "block 001"), "a name of its own", replaced(CSV, "002,flat", "001,flat")),
    Case("a block named by a path", IMPORT, "block-name-invalid", ("conditions.csv", "row 4", "../002"), "name of letters", replaced(CSV, "002,flat", "../002,flat")),
    Case("NaN radiance", IMPORT, "radiance-invalid", ("conditions.csv", "row 3", "radiance"), "correct the cell", replaced(CSV, "20.1", "nan")),
    Case("negative radiance", IMPORT, "radiance-invalid", ("conditions.csv", "row 3", "radiance"), "correct the cell", replaced(CSV, "20.1", "-20.1")),
    Case("negative exposure", IMPORT, "conditions-invalid", ("conditions.csv", "row 3", "exposure_us"), "correct the cell", replaced(CSV, "001,flat,10.0", "001,flat,-10.0")),
    Case("exposure of zero", IMPORT, "conditions-invalid", ("conditions.csv", "row 2", "exposure_us"), "correct the cell", replaced(CSV, "000,dark,10.0", "000,dark,0")),
    Case("text in place of a number", IMPORT, "conditions-invalid", ("conditions.csv", "row 3", "exposure_us"), "correct the cell", replaced(CSV, "001,flat,10.0", "001,flat,ten")),
    Case("a kind of block that does not exist", IMPORT, "conditions-invalid", ("conditions.csv", "row 2", "kind"), "'dark', 'flat' or 'scene'", replaced(CSV, "000,dark", "000,black")),
    Case("a flat without its level", IMPORT, "conditions-invalid", ("conditions.csv", "row 3", "level"), "give the number of lamps", replaced(CSV, "10.0,2.0", "10.0,")),
    Case("a scene without its image", IMPORT, "scene-missing", ("landscape", "scenes"), "add it there", scene_named(CSV, "landscape")),
    Case("conditions.csv not UTF-8", IMPORT, "conditions-invalid", ("conditions.csv",), "save it as UTF-8", written(CSV, "Bl\xf6cke".encode("latin-1"))),
    Case("recording.toml missing", IMPORT, "recording-incomplete", ("recording.toml",), "add it", removed(TOML)),
    Case("recording.toml not TOML", IMPORT, "header-invalid", ("recording.toml", "line 4"), "correct", replaced(TOML, "columns =", "columns")),
    Case("recording.toml not UTF-8", IMPORT, "header-invalid", ("recording.toml",), "save it as UTF-8", written(TOML, '[camera]\nmodel = "Z\xfcrich"'.encode("latin-1"))),
    Case("recording.toml without columns", IMPORT, "header-invalid", ("recording.toml", "camera.columns"), "add it", replaced(TOML, "columns = 64\n", "")),
    Case("a huge number of columns", IMPORT, "header-invalid", ("recording.toml", "camera.columns = 9000000000"), "less than or equal to 1048576", replaced(TOML, "columns = 64", "columns = 9000000000")),
    Case("a number of columns beyond 64 bits", IMPORT, "header-invalid", ("recording.toml", "camera.columns"), "less than or equal to 1048576", replaced(TOML, "columns = 64", "columns = 99999999999999999999999")),
    Case("started_at without a time zone", IMPORT, "header-invalid", ("recording.toml", "camera.started_at", "no time zone"), "write it in UTC", value(TOML, "started_at", "2026-11-22T09:30:00")),
    Case("started_at that is no time", IMPORT, "header-invalid", ("recording.toml", "camera.started_at = 'noon'"), "should be a valid datetime", value(TOML, "started_at", '"noon"')),
    Case("a tap layout that does not exist", IMPORT, "header-invalid", ("recording.toml", "camera.tap_layout"), "'odd_even'", replaced(TOML, "odd_even", "odd-even")),
)  # fmt: skip
