"""Has the package `emva1288` reduce a recording folder; run by the peers' own interpreter.

    .venv-peers/bin/python benchmarks/emva1288_peer.py FOLDER DARK FLAT

The pairs of every exposure are its temporal images, the blocks DARK and FLAT its spatial ones. Its
results are printed as JSON. It stands alone, since its environment (numpy < 2) has nothing of ours.
"""

import contextlib
import csv
import json
import logging
import sys
import tomllib
from pathlib import Path

import numpy as np
from emva1288.process import routines
from emva1288.process.data import Data1288
from emva1288.process.results import Results1288

NS_PER_US = 1e3


def main():
    folder, dark, flat = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    camera = tomllib.loads((folder / "recording.toml").read_text())
    rate = camera["source"]["photons_per_pixel_per_us"]
    with (folder / "conditions.csv").open(newline="") as file:
        blocks = {row["block"]: row for row in csv.DictReader(file)}
    temporal, spatial = {}, {}
    for name, row in blocks.items():
        exposure_us = float(row["exposure_us"])
        photons = rate * exposure_us * float(row["level"])
        images = list(np.load(folder / "frames" / f"{name}.npy"))
        found = routines.get_int_imgs(images)
        if name not in {dark, flat}:  # as its LoadImageData does
            found = {**found, "sum": np.sum(found["sum"]), "pvar": np.sum(found["pvar"])}
        into = spatial if name in {dark, flat} else temporal
        into.setdefault(exposure_us * NS_PER_US, {})[photons] = found
    data = {
        "temporal": temporal,
        "spatial": spatial,
        "width": camera["camera"]["columns"],
        "height": camera["camera"]["rows"],
    }
    with contextlib.redirect_stdout(sys.stderr):
        results = Results1288(Data1288(data, loglevel=logging.ERROR).data, loglevel=logging.ERROR)
        values = {name: one.get("value") for name, one in results.results.items()}
    found = {k: float(v) for k, v in values.items() if v is not None and np.isscalar(v)}
    print(json.dumps(found))


if __name__ == "__main__":
    main()
