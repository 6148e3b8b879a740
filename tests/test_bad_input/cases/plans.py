"""Plans that cannot be run."""
# ruff: noqa: E501 - a table is read by rows

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import folder_instead, replaced, written

DRY = "sweep plan.toml --dry-run"
PLAN = "plan.toml"

CASES = (
    Case("plan not found", "sweep nowhere.toml --dry-run", "plan-unreadable", ("nowhere.toml",), "give a .toml"),
    Case("a folder in place of a plan", DRY, "plan-unreadable", (PLAN,), "give a .toml", folder_instead(PLAN)),
    Case("plan not TOML", DRY, "plan-invalid", (PLAN, "line 3"), "correct it", replaced(PLAN, "lines =", "lines")),
    Case("plan not UTF-8", DRY, "plan-unreadable", (PLAN,), "give a .toml", written(PLAN, 'name = "Z\xfcrich"'.encode("latin-1"))),
    Case("plan empty", DRY, "plan-invalid", (PLAN, "sweep is missing"), "add it", written(PLAN, "")),
    Case("a typo in a plan", DRY, "plan-invalid", (PLAN, "sweep.exposure_us"), "did you mean exposures_us?", replaced(PLAN, "exposures_us", "exposure_us")),
    Case("a table that a plan does not have", DRY, "plan-invalid", (PLAN, "lights"), "allowed are", replaced(PLAN, "[source]", "[lights]")),
    Case("a sweep that does not exist", DRY, "plan-invalid", (PLAN, "sweep.type = 'factorail'"), "'factorial'", replaced(PLAN, '"factorial"', '"factorail"')),
    Case("a sweep without its type", DRY, "plan-invalid", (PLAN, "sweep.type is missing"), "'factorial'", replaced(PLAN, 'type = "factorial"', "")),
    Case("a plan of negative exposures", DRY, "plan-invalid", (PLAN, "sweep.exposures_us[0] = -10.0"), "greater than 0", replaced(PLAN, "[10.0", "[-10.0")),
    Case("a plan of infinite exposures", DRY, "plan-invalid", (PLAN, "sweep.exposures_us[0] = inf"), "should be a finite number", replaced(PLAN, "[10.0", "[inf")),
    Case("a plan of no exposures", DRY, "plan-invalid", (PLAN, "sweep.exposures_us"), "at least 1", replaced(PLAN, "[10.0, 40.0, 90.0]", "[]")),
    Case("a plan of exposures longer than a line", DRY, "plan-invalid", (PLAN, "110", "camera.line_period_us"), "shorten it", replaced(PLAN, "90.0]", "110.0]")),
    Case("a plan of text in place of a number", DRY, "plan-invalid", (PLAN, "lines = 'many'"), "integer", replaced(PLAN, "lines = 64", 'lines = "many"')),
    Case("a plan of no lines", DRY, "plan-invalid", (PLAN, "lines = 0"), "greater than or equal to 1", replaced(PLAN, "lines = 64", "lines = 0")),
    Case("a plan of frames that do not divide its lines", DRY, "plan-invalid", (PLAN, "frame_lines = 30"), "does not divide", replaced(PLAN, "frame_lines = 32", "frame_lines = 30")),
    Case("a plan of a pixel format that does not exist", DRY, "plan-invalid", (PLAN, "camera.pixel_format = 'Mono11'"), "'Mono12'", replaced(PLAN, "Mono12", "Mono11")),
    Case("a plan of more lamps than there are", DRY, "plan-invalid", (PLAN, "level 4", "source.lamps = 3"), "correct one", replaced(PLAN, "[source]", "[source]\nkind = \"sphere\"\nlamps = 3")),
    Case("a plan of negative radiance", DRY, "plan-invalid", (PLAN, "source.radiance.2 = -20.1"), "greater than or equal to 0", replaced(PLAN, "20.1", "-20.1")),
    Case("a plan of NaN radiance", DRY, "plan-invalid", (PLAN, "source.radiance.2 = nan"), "should be a finite number", replaced(PLAN, "20.1", "nan")),
    Case("a plan of a huge number of columns", DRY, "plan-invalid", (PLAN, "camera.columns"), "less than or equal to 1048576", replaced(PLAN, "columns = 64", "columns = 99999999999999999999999")),
    Case("a plan of a number without bounds", DRY, "plan-invalid", (PLAN, "camera.line_period_us"), "should be a finite number", replaced(PLAN, "line_period_us = 100.0", "line_period_us = inf")),
    Case("a plan of too many repeats", DRY, "plan-invalid", (PLAN, "100000 blocks"), "lower repeats", replaced(PLAN, "lines = 64", "lines = 64\nrepeats = 1000000000")),
    Case("a plan's scene unnamed", DRY, "plan-invalid", (PLAN, "sweep.blocks[0]"), "give scene", replaced(PLAN, 'type = "factorial"\nexposures_us = [10.0, 40.0, 90.0]\nlevels = [2.0, 4.0]', 'type = "listed"\nblocks = [{ kind = "scene", exposure_us = 40.0 }]')),
    Case("plan in JSON not JSON", "sweep plan.json --dry-run", "plan-invalid", ("plan.json",), "correct it", written("plan.json", "{")),
    Case("plan in JSON of NaN", "sweep plan.json --dry-run", "plan-invalid", ("plan.json", "sweep is missing"), "add it", written("plan.json", '{"lines": NaN}')),
    Case("plan in JSON that is a list", "sweep plan.json --dry-run", "plan-invalid", ("plan.json",), "should be a table", written("plan.json", "[1]")),
    Case("plan in JSON nested too deep", "sweep plan.json --dry-run", "plan-invalid", ("plan.json",), "correct it", written("plan.json", "[" * 100_000)),
)  # fmt: skip
