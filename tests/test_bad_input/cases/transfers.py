"""Recordings that do not determine photon transfer, and outputs that cannot be written."""
# ruff: noqa: E501 - a table is read by rows

import numpy as np

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import frames, rows, written

CURVE = "photon-transfer rec --out maps.h5"
SANUC = "photon-transfer rec --method sanuc --out maps.h5"

CASES = (
    Case("no exposure twice another", SANUC, "not-doubled", ("rec", "twice"), "record"),
    Case("maps beside the curve, no exposure twice another", CURVE, "not-doubled", ("rec", "twice"), "record"),
    Case("one flat for two exposures", SANUC, "two-flats-missing", ("rec",), "record", rows(lambda row: row["kind"] == "dark" or row["exposure_us"] == "40.0")),
    Case("flats missing for the curve", "photon-transfer rec", "no-temporal-noise", ("rec",), "record", rows(lambda row: row["kind"] == "dark")),
    Case("every flat saturated for the curve", "photon-transfer rec", "photon-transfer-range", ("rec",), "record flats of less light", frames(lambda dn: np.full_like(dn, 4095), "001", "002", "004", "005", "007", "008")),
    Case("a data sheet without darks", "photon-transfer rec --report out.html", "no-data-sheet", ("rec", "dark"), "record", rows(lambda row: row["kind"] != "dark")),
    Case("maps are there already", SANUC, "output-exists", ("maps.h5",), "name another output", written("maps.h5", "mine")),
    Case("data sheet is there already", "photon-transfer rec --data-sheet out.xml", "output-exists", ("out.xml",), "name another output", written("out.xml", "mine")),
    Case("a recording for photon transfer not found", "photon-transfer nowhere", "recording-not-found", ("nowhere",), "name an .h5 file"),
)  # fmt: skip
