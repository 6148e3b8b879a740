"""Scans of a grating and images of an edge that do not determine a transfer function."""
# ruff: noqa: E501 - a table is read by rows

import shutil
from pathlib import Path

import numpy as np

from calib.mtf.geometry import Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.simulation.bench import Bench
from calib.mtf.simulation.folder import write_folder
from calib.mtf.simulation.shapes import square
from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import (
    cut,
    folder_instead,
    images,
    removed,
    renamed,
    replaced,
    several,
    value,
    written,
)

SCAN, EDGE = "mtf scan --out TF.h5", "mtf slanted --out TF.h5"
HEADER, FRAME = "scan/mtf.toml", "scan/frames/004.npy"
BRIGHTEST = 150_000.0  # of 50,000 electrons' mean


def _one_straight_frame(folder: Path) -> None:
    bench = Bench(Scan(25.0, 0, 1), Grating(650, 500.0), square(25.0, 1.0), (20, 20))
    shutil.rmtree(folder / "scan")
    write_folder(folder / "scan", bench.scan, bench.grating, bench.light())


CASES = (
    Case("a scan not found", "mtf nowhere --out TF.h5", "not-a-folder", ("nowhere",), "name the folder"),
    Case("a file in place of a scan", "mtf plan.toml --out TF.h5", "not-a-folder", ("plan.toml",), "name the folder"),
    Case("a scan without mtf.toml", SCAN, "not-found", ("mtf.toml", "scan"), "add it", removed(HEADER)),
    Case("a folder in place of mtf.toml", SCAN, "header-invalid", (HEADER,), "correct it", folder_instead(HEADER)),
    Case("mtf.toml not TOML", SCAN, "header-invalid", (HEADER, "line 1"), "correct it", replaced(HEADER, "pitch_um", "pitch um")),
    Case("mtf.toml not UTF-8", SCAN, "header-invalid", (HEADER, "byte 0"), "correct it", written(HEADER, b"\xff\xfe")),
    Case("mtf.toml empty", SCAN, "header-invalid", (HEADER, "pitch_um"), "add it", written(HEADER, "")),
    Case("mtf.toml without a grating", SCAN, "header-invalid", (HEADER, "[grating]"), "add it", replaced(HEADER, "[grating]", "[grate]")),
    Case("a grating and an edge in one folder", SCAN, "header-invalid", (HEADER, "[edge]"), "remove", replaced(HEADER, "[grating]", "[edge]\n[grating]")),
    Case("a key of mtf.toml of the wrong type", SCAN, "header-invalid", (HEADER, "scan.n"), "integer", value(HEADER, "n", "3.5")),
    Case("a pitch that cannot be", SCAN, "bad-pitch", ("scan", "pitch_um = 0.0"), "give", value(HEADER, "pitch_um", "0.0")),
    Case("a grating's period that cannot be", SCAN, "bad-grating", ("scan", "period of nan"), "give", value(HEADER, "period_um", "nan")),
    Case("a circle without orders", SCAN, "no-orders", ("scan", "eta2 = 51"), "try 650", value(HEADER, "eta2", "51")),
    Case("a huge circle of orders", SCAN, "header-invalid", (HEADER, "eta2"), "less than", value(HEADER, "eta2", "1000000000000")),
    Case("more harmonics than can be fitted", SCAN, "too-many-harmonics", (HEADER, "eta2 = 5928325"), "fewer orders", value(HEADER, "eta2", "5928325")),
    Case("m and n not coprime", SCAN, "not-coprime", ("scan", "m = 3", "n = 3"), "choose others", value(HEADER, "m", "3")),
    Case("more stage positions than numbers for them", SCAN, "too-many-positions", (HEADER, "n = 1000000"), "choose smaller", value(HEADER, "n", "1000000")),
    Case("a missing position that is none", SCAN, "missing-wrong", (HEADER, "10"), "correct it", replaced(HEADER, "n = 3", "n = 3\nmissing = [10]")),
    Case("every position missing", SCAN, "missing-wrong", (HEADER,), "record", replaced(HEADER, "n = 3", f"n = 3\nmissing = {list(range(10))}")),
    Case("no frames", SCAN, "frames-missing", ("scan/frames",), "add", removed("scan/frames")),
    Case("a frame missing", SCAN, "frames-missing", ("frame 004", "scan/frames"), "missing = [4]", removed(FRAME)),
    Case("two frames missing", SCAN, "frames-missing", ("frames 004, 007", "scan/frames"), "missing = [4, 7]", several(removed(FRAME), removed("scan/frames/007.npy"))),
    Case("a folder in place of a frame", SCAN, "frames-missing", ("frame 004",), "put it back", folder_instead(FRAME)),
    Case("more frames than positions", SCAN, "frames-extra", ("scan/frames", "010.npy"), "move it away", renamed("slanted/frames/000.npy", "scan/frames/010.npy")),
    Case("a frame cut short", SCAN, "frames-unreadable", (FRAME,), "save it again", cut(FRAME, 0.7)),
    Case("a frame without content", SCAN, "frames-unreadable", (FRAME,), "save it again", written(FRAME, "")),
    Case("several arrays in place of a frame", SCAN, "frames-unreadable", (FRAME,), "numpy.save", lambda folder: (np.savez(folder / "two.npz", a=np.ones(3)), (folder / "two.npz").rename(folder / FRAME))),
    Case("a frame of another shape", SCAN, "frames-wrong-shape", (FRAME, "(28, 29)"), "record all frames alike", images(lambda image: image[:, 1:], "004")),
    Case("single frames in place of their mean", SCAN, "frames-wrong-shape", (FRAME, "(1, 28, 30)"), "average", images(lambda image: image[None], "004")),
    Case("a frame of complex numbers", SCAN, "frames-wrong-dtype", (FRAME, "complex128"), "float64", images(lambda image: image + 1j, "004")),
    Case("a frame that holds NaN", SCAN, "frames-not-finite", (FRAME, "row 0, column 0"), "replace", images(lambda image: image * np.nan, "004")),
    Case("a frame in the wrong byte order", SCAN, "frames-out-of-range", (FRAME,), "byte order", images(lambda image: np.full_like(image, 1e200), "004")),
    Case("frames without light", SCAN, "no-pattern", ("scan",), "check", images(lambda image: 0 * image)),
    Case("frames without a pattern", SCAN, "no-pattern", ("scan",), "check", images(lambda image: 0 * image + 20_000)),
    Case("another grating than mtf.toml says", SCAN, "no-pattern", ("scan",), "check", value(HEADER, "period_um", "290.0")),
    Case("a grating too fine for the pitch", SCAN, "no-pattern", ("scan",), "longer period", value(HEADER, "period_um", "5.0")),
    Case("saturated frames", SCAN, "saturated", ("scan",), "less light", images(lambda image: np.minimum(image, BRIGHTEST))),
    Case("one straight view of the pattern", SCAN, "aliased", ("scan",), "record more", _one_straight_frame),
    Case("a transfer function is there already", SCAN, "output-exists", ("TF.h5",), "name another output", written("TF.h5", "mine")),
    Case("a transfer function where no folder is", "mtf scan --out nowhere/TF.h5", "cannot-write", ("nowhere/TF.h5",), "another folder"),
    Case("a report over its transfer function", "mtf scan --out TF.h5 --report TF.h5", "output-named-twice", ("TF.h5",), "name another"),
    Case("a report of a transfer function where no folder is", "mtf scan --out TF.h5 --report nowhere/r.html", "cannot-write", ("nowhere/r.html",), "name a file"),
    Case("a set for the transfer function not found", "mtf scan --out TF.h5 --set nowhere.h5 --set-out new.h5", "not-found", ("nowhere.h5",), "give the path"),
    Case("a set with the transfer function over another file", "mtf scan --out TF.h5 --set set.h5 --set-out plan.toml", "output-exists", ("plan.toml",), "name another output"),
    Case("a set with the transfer function over the set", "mtf scan --out TF.h5 --set set.h5 --set-out set.h5", "output-exists", ("set.h5",), "name another output"),
    Case("an edge's pitch that cannot be", EDGE, "bad-pitch", ("slanted", "nan"), "give", value("slanted/mtf.toml", "pitch_um", "nan")),
    Case("an edge's direction that is none", EDGE, "header-invalid", ("slanted/mtf.toml", "direction"), "'x' or 'y'", replaced("slanted/mtf.toml", "[edge]", '[edge]\ndirection = "z"')),
    Case("no image of the edge", EDGE, "frames-missing", ("slanted/frames",), "add", removed("slanted/frames/000.npy")),
    Case("an image without an edge", EDGE, "no-edge", ("slanted",), "show one edge", images(lambda image: 0 * image + 7, of="slanted")),
    Case("an upright edge", EDGE, "no-slant", ("slanted",), "slant it", images(lambda image: image[59:60].repeat(120, axis=0), of="slanted")),
    Case("an edge in a single row", EDGE, "no-slant", ("slanted",), "slant it", images(lambda image: image[:1], of="slanted")),
    Case("an edge that leaves the image", EDGE, "edge-at-border", ("slanted",), "cut the image", images(lambda image: image[:, :25], of="slanted")),
    Case("an edge of too few rows", EDGE, "edge-too-short", ("slanted",), "more rows", images(lambda image: image[50:64], of="slanted")),
    Case("a report of an edge", "mtf slanted --out TF.h5 --report r.html", "edge-only", ("slanted",), "leave out"),
)  # fmt: skip
