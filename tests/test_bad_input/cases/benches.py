"""Bench files that cannot be opened, and plans that do not fit the bench."""
# ruff: noqa: E501 - a table is read by rows

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import folder_instead, replaced, several, written

SWEEP = "sweep plan.toml --bench bench.toml --out out.h5"
BENCH = "bench.toml"

CASES = (
    Case("bench file not found", "sweep plan.toml --bench nowhere.toml --out out.h5", "bench-unreadable", ("nowhere.toml",), "name a bench file"),
    Case("a folder in place of a bench file", SWEEP, "bench-unreadable", (BENCH,), "name a bench file", folder_instead(BENCH)),
    Case("bench file not TOML", SWEEP, "bench-invalid", (BENCH, "line 2"), "correct it", replaced(BENCH, "id =", "id")),
    Case("bench file not UTF-8", SWEEP, "bench-unreadable", (BENCH,), "in UTF-8", written(BENCH, b"id = '\xff'")),
    Case("a typo in a bench file", SWEEP, "bench-invalid", (BENCH, "light.ramps_s"), "did you mean ramp_s?", replaced(BENCH, "ramp_s", "ramps_s")),
    Case("a driver that does not exist", SWEEP, "bench-invalid", (BENCH, "camera.driver = 'moc'"), "'mock'", replaced(BENCH, 'driver = "mock"\npaced', 'driver = "moc"\npaced')),
    Case("a bench without a light", SWEEP, "bench-invalid", (BENCH, "light is missing"), "add it", replaced(BENCH, '[light]\ndriver = "mock"\nramp_s = 0.0\n', "")),
    Case("mock devices without a simulation", SWEEP, "bench-invalid", (BENCH, "[simulation]"), "add one", replaced(BENCH, '[simulation]\nmodel = "demo"\nseed = 3\n', "")),
    Case("a bench of an unknown model", SWEEP, "unknown-preset", ("'demoo'",), "demo", replaced(BENCH, '"demo"', '"demoo"')),
    Case("a bench of a model file that is not there", SWEEP, "unreadable", ("nowhere.toml",), "give a model file", replaced(BENCH, '"demo"', '"nowhere.toml"')),
    Case("a serial port that is not there", SWEEP, "device-not-found", ("monitor", "/dev/ttyNOWHERE"), "is it plugged in?", replaced(BENCH, '[monitor]\ndriver = "mock"\nintegration_s = 0.001', '[monitor]\ndriver = "keithley6485"\nport = "/dev/ttyNOWHERE"')),
    Case("a serial port that is a file", SWEEP, "device-failed", ("monitor", "plan.toml"), "cannot be opened", replaced(BENCH, '[monitor]\ndriver = "mock"\nintegration_s = 0.001', '[monitor]\ndriver = "keithley6485"\nport = "plan.toml"')),
    Case("a plan for another camera", SWEEP, "wrong-camera", ("D0002", "D0001"), "is connected", replaced("plan.toml", "D0001", "D0002")),
    Case("a plan of more lamps than the bench has", SWEEP, "level-out-of-range", ("level 7", "bad-input"), "goes to 6", several(replaced("plan.toml", "D0001", ""), replaced("plan.toml", "4.0]", "7.0]"))),
    Case("a plan of more columns than the bench's camera has", SWEEP, "setting-out-of-range", ("first_column = 480",), "0 .. 24", several(replaced("plan.toml", "D0001", ""), replaced("plan.toml", "columns = 64", "columns = 1000"))),
    Case("nothing to resume", f"{SWEEP} --resume", "nothing-to-resume", ("out.h5",), "without --resume"),
    Case("resuming another plan's recording", "sweep plan.toml --bench bench.toml --out rec.h5 --resume", "plan-changed", ("rec.h5",), "begin a new recording", several(replaced("plan.toml", "D0001", ""), replaced("plan.toml", "90.0", "95.0"))),
)  # fmt: skip
