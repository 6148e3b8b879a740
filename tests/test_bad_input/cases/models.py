"""Models that cannot be simulated, and plans that do not fit them."""
# ruff: noqa: E501 - a table is read by rows

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import folder_instead, removed, replaced, written

SIMULATE = "simulate model.toml plan.toml --out out.h5 --seed 3"
MODEL, PLAN = "model.toml", "plan.toml"

CASES = (
    Case("model not found", "simulate nowhere.toml plan.toml --out out.h5", "unreadable", ("nowhere.toml",), "give a model file"),
    Case("preset that does not exist", "simulate agcam plan.toml --out out.h5", "unknown-preset", ("'agcam'",), "agcam-nir"),
    Case("a folder in place of a model", SIMULATE, "unreadable", (MODEL,), "give a model file", folder_instead(MODEL)),
    Case("model not TOML", SIMULATE, "not-toml", (MODEL, "line 2"), "correct it", replaced(MODEL, "model =", "model")),
    Case("model not UTF-8", SIMULATE, "unreadable", (MODEL,), "give a model file", written(MODEL, b"\xff\xfe")),
    Case("model empty", SIMULATE, "bad-header", (MODEL, "[camera] columns"), "add it", written(MODEL, "")),
    Case("a table that a model does not have", SIMULATE, "unknown-key", (MODEL, "'light'"), "allowed: camera", replaced(MODEL, "[source]", "[light]")),
    Case("an effect that does not exist", SIMULATE, "unknown-effect", ("'dark_curent'",), "dark_current", replaced(MODEL, "[effects.adc]", "[effects.dark_curent]")),
    Case("a typo in a model", SIMULATE, "unknown-key", (MODEL, "[effects.read_noise]", "'std'"), "allowed: std_e", replaced(MODEL, "std_e", "std")),
    Case("a typo in a model's camera", SIMULATE, "unknown-key", (MODEL, "[camera]", "'colums'"), "allowed: ", replaced(MODEL, "columns =", "colums =")),
    Case("a parameter out of bounds", SIMULATE, "parameter-out-of-bounds", (MODEL, "read_noise", "std_e is -12"), "give 0", replaced(MODEL, "std_e = 12", "std_e = -12")),
    Case("a parameter that is NaN", SIMULATE, "parameter-out-of-bounds", (MODEL, "read_noise", "std_e is nan"), "give 0", replaced(MODEL, "std_e = 12.0", "std_e = nan")),
    Case("a parameter of the wrong type", SIMULATE, "wrong-type", (MODEL, "[effects.read_noise]", "std_e is 'low'"), "give a", replaced(MODEL, "std_e = 12.0", 'std_e = "low"')),
    Case("an effect that is no table", SIMULATE, "wrong-type", (MODEL, "shot_noise"), "give one", replaced(MODEL, "[effects.shot_noise]", "[effects]\nshot_noise = 1")),
    Case("a link missing that no chain can do without", SIMULATE, "effect-missing", (MODEL, "adc"), "add it", replaced(MODEL, "[effects.adc]\nbit_depth = 12\n", "")),
    Case("bit depths of camera and converter that differ", SIMULATE, "bit-depth-mismatch", (MODEL, "bit_depth is 10"), "give one for both", replaced(MODEL, "[effects.adc]\nbit_depth = 12", "[effects.adc]\nbit_depth = 10")),
    Case("a model of a huge area sensor", SIMULATE, "too-many-pixels", (MODEL, "1000000 rows"), "give fewer", replaced(MODEL, "columns = 1024", "columns = 1024\nrows = 1000000")),
    Case("an optical axis in the rows of a line sensor", SIMULATE, "area-sensor", (MODEL, "axis_row is 3"), "leave it out", replaced(MODEL, "axis_column =", "axis_row = 3.0\naxis_column =")),
    Case("a model of a huge number of columns", SIMULATE, "bad-header", (MODEL, "[camera] columns"), "less than or equal to 1048576", replaced(MODEL, "columns = 1024", "columns = 1000000000000")),
    Case("a model without lamps", SIMULATE, "bad-level", (PLAN, "block 001", "level is 2"), "give a whole number of lamps", replaced(MODEL, "radiance = [\n    10.2,\n    9.9,\n    10.0,\n    10.1,\n    9.8,\n    10.0,\n]", "radiance = []")),
    Case("a plan of more lamps than the model has", SIMULATE, "bad-level", (PLAN, "block 002", "level is 9"), "0 to 6", replaced(PLAN, "4.0]", "9.0]")),
    Case("a plan of another bit depth than the model", SIMULATE, "plan-does-not-fit-model", (PLAN, "Mono8", "12"), "change camera.pixel_format", replaced(PLAN, "Mono12", "Mono8")),
    Case("a plan of more columns than the model has", SIMULATE, "plan-does-not-fit-model", (PLAN, "1480", "1024"), "lower camera.columns", replaced(PLAN, "columns = 64", "columns = 1000")),
    Case("a plan's scene missing", SIMULATE, "scene-missing", (PLAN, "field", "scenes"), "add it there", replaced(PLAN, 'type = "factorial"\nexposures_us = [10.0, 40.0, 90.0]\nlevels = [2.0, 4.0]', 'type = "listed"\nblocks = [{ kind = "scene", exposure_us = 40.0, scene = "field" }]')),
    Case("a plan that is not there", SIMULATE, "plan-unreadable", (PLAN,), "give a .toml", removed(PLAN)),
)  # fmt: skip
