"""Recordings that are sound but do not determine a calibration, and arguments that do not fit."""
# ruff: noqa: E501 - a table is read by rows

import numpy as np

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import frames, removed, replaced, rows, several, written

CALIBRATE = "calibrate rec --out out.h5"
CSV, TOML = "rec/conditions.csv", "rec/recording.toml"

WITH_MODEL = f"{CALIBRATE} --model model.toml"
MODEL = "model.toml"
FITS = replaced(MODEL, "columns = 1024", "columns = 64")
"""A model of the camera that made the recording."""
WITH_TABLE = f"{CALIBRATE} --radiances radiances.csv"

CASES = (
    Case("darks missing", CALIBRATE, "missing-darks", ("rec", "no capped dark"), "record darks", rows(lambda row: row["kind"] != "dark")),
    Case("flats missing", CALIBRATE, "no-flats", ("rec", "no flat"), "record uniform light", rows(lambda row: row["kind"] == "dark")),
    Case("one exposure only", CALIBRATE, "one-exposure", ("rec", "two exposures or more"), "record flats", rows(lambda row: row["exposure_us"] == "40.0")),
    Case("all flats saturated", CALIBRATE, "all-saturated", ("rec", "clipped"), "shorter exposures", frames(lambda dn: np.full_like(dn, 4095), "001", "002", "004", "005", "007", "008")),
    Case("every code zero", CALIBRATE, "all-saturated", ("rec", "clipped"), "record", frames(np.zeros_like)),
    Case("one line per block", CALIBRATE, "no-temporal-noise", ("rec", "two lines or more"), "record blocks of many lines", several(frames(lambda dn: dn[:1].copy()), lambda folder: (folder / CSV).write_text((folder / CSV).read_text().replace(",64,", ",1,")))),
    Case("no radiance", CALIBRATE, "no-radiance", ("rec", "No flat has a radiance"), "give the radiance", lambda folder: (folder / CSV).write_text((folder / CSV).read_text().replace(",20.1", ",").replace(",40.2", ","))),
    Case("radiance zero in the light", CALIBRATE, "bad-radiance", ("rec", "Block 001"), "leave it empty", lambda folder: (folder / CSV).write_text((folder / CSV).read_text().replace(",20.1", ",0"))),
    Case("an area sensor", CALIBRATE, "area-sensor", ("rec", "area sensor"), "give a recording of a line sensor", several(frames(lambda dn: dn.reshape(16, 4, 64)), replaced(TOML, "columns = 64", "columns = 64\nrows = 4"), lambda folder: (folder / CSV).write_text((folder / CSV).read_text().replace(",64,", ",16,")))),
    Case("sums alone, no frames", CALIBRATE, "frames-missing", ("rec", "statistics.csv"), "this needs frames/000.npy", several(removed("rec/frames"), written("rec/statistics.csv", "block,samples,mean_dn,variance_dn2\n" + "".join(f"00{k},4096,100,4\n" for k in range(9))))),
    Case("a recording to calibrate not found", "calibrate nowhere --out out.h5", "recording-not-found", ("nowhere",), "name an .h5 file"),
    Case("a model of another width", WITH_MODEL, "model-mismatch", ("columns is 1024", "64"), "give the model of this camera"),
    Case("a model of another bit depth", WITH_MODEL, "model-mismatch", ("bit_depth is 10", "12"), "give the model of this camera", several(FITS, lambda folder: (folder / MODEL).write_text((folder / MODEL).read_text().replace("bit_depth = 12", "bit_depth = 10")))),
    Case("a model of another camera", WITH_MODEL, "model-mismatch", ("serial is 'D0002'",), "give the model of this camera", several(FITS, replaced(MODEL, 'serial = "D0001"', 'serial = "D0002"'))),
    Case("a model in another unit of radiance", WITH_MODEL, "model-unit", ("'candela'",), "give both in one unit", several(FITS, replaced(MODEL, 'radiance_unit = "W m-2 sr-1"', 'radiance_unit = "candela"'))),
    Case("a model to calibrate with not found", f"{CALIBRATE} --model nowhere.toml", "unreadable", ("nowhere.toml",), "give a model file"),
    Case("a model with an unknown departure", WITH_MODEL, "unknown-effect", ("'lagg'",), "lag", several(FITS, replaced(MODEL, "[effects.adc]", "[effects.lagg]\nshare = 0.01\n\n[effects.adc]"))),
    Case("a model on a relative scale", f"{WITH_MODEL} --relative", "relative-with-model", ("relative scale",), "give the radiances", FITS),
    Case("departures that nothing can be fitted beside", WITH_MODEL, "departures-too-strong", ("no response settles",), "check their parameters", several(FITS, replaced(MODEL, "[effects.adc]", "[effects.nonlinearity]\nbeta_per_dn = 0.01\n\n[effects.adc]"))),
    Case("an uncertainty of an effect that the model lacks", WITH_MODEL, "effect-missing", (MODEL, "'lag'"), "give those of", several(FITS, replaced(MODEL, "[effects.adc]", "[uncertainty.lag]\nshare = 0.01\n\n[effects.adc]"))),
    Case("an uncertainty of a parameter that there is not", WITH_MODEL, "unknown-key", (MODEL, "'std'"), "name one", several(FITS, replaced(MODEL, "[effects.adc]", "[uncertainty.read_noise]\nstd = 0.01\n\n[effects.adc]"))),
    Case("a negative uncertainty", WITH_MODEL, "bad-uncertainty", (MODEL, "std_e = -1"), "give a number", several(FITS, replaced(MODEL, "[effects.adc]", "[uncertainty.read_noise]\nstd_e = -1.0\n\n[effects.adc]"))),
    Case("table of radiances not found", f"{CALIBRATE} --radiances nowhere.csv", "radiances-unreadable", ("nowhere.csv",), "give a table"),
    Case("table of radiances with text", WITH_TABLE, "radiances-unreadable", ("radiances.csv, line 2",), "write `level,radiance`", replaced("radiances.csv", "20.1", "bright")),
    Case("table of radiances with another heading", WITH_TABLE, "radiances-unreadable", ("radiances.csv",), "write `level,radiance`", replaced("radiances.csv", "level", "lamps")),
    Case("table of radiances with NaN", WITH_TABLE, "bad-radiance", ("rec", "level 2 is nan"), "give a positive number", replaced("radiances.csv", "20.1", "nan")),
    Case("table of radiances negative", WITH_TABLE, "bad-radiance", ("rec", "level 2 is -1"), "give a positive number", replaced("radiances.csv", "20.1", "-1")),
    Case("table of radiances with a level twice", WITH_TABLE, "radiances-unreadable", ("line 3", "level 2"), "keep one", replaced("radiances.csv", "4,", "2,")),
    Case("table of radiances empty", WITH_TABLE, "radiances-unreadable", ("radiances.csv",), "give `level,radiance`", written("radiances.csv", "")),
    Case("table of radiances not UTF-8", WITH_TABLE, "radiances-unreadable", ("radiances.csv",), "in UTF-8", written("radiances.csv", b"level,radiance\n2,\xff\n")),
    Case("table of radiances for other levels", WITH_TABLE, "no-radiance", ("rec", "No flat has a radiance"), "give the radiance", several(lambda folder: (folder / CSV).write_text((folder / CSV).read_text().replace(",20.1", ",").replace(",40.2", ",")), written("radiances.csv", "level,radiance\n1,5\n"))),
    Case("a tone that cannot be", f"{CALIBRATE} --tone nan 70", "tone-invalid", ("tone of nan",), "give more than 0"),
    Case("too few columns for a vignette", CALIBRATE, "too-few-columns", ("rec", "10 of 10 columns"), "look at the masked columns", several(frames(lambda dn: dn[:, :10].copy()), replaced(TOML, "columns = 64", "columns = 10"))),
    Case("a certificate's uncertainty that is negative", CALIBRATE, "header-invalid", ("recording.toml", "source.certificate_relative_std = -0.1"), "greater than or equal to 0", replaced(TOML, 'kind = "sphere"', 'kind = "sphere"\ncertificate_relative_std = -0.1')),
    Case("a certificate's uncertainty that is text", CALIBRATE, "header-invalid", ("recording.toml", "source.certificate_relative_std = 'small'"), "should be a valid number", replaced(TOML, 'kind = "sphere"', 'kind = "sphere"\ncertificate_relative_std = "small"')),
)  # fmt: skip
