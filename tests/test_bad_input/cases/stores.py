"""What the store of coefficient sets does not take."""
# ruff: noqa: E501 - a table is read by rows

from tests.test_bad_input.case import Case
from tests.test_bad_input.damage import altered_array, written

CASES = (
    Case("a set for the store not found", "store add nowhere.h5", "not-found", ("nowhere.h5",), "give the path"),
    Case("a recording for the store", "store add rec.h5", "not-a-coefficient-set", ("rec.h5",), "calibrate again"),
    Case("an altered set for the store", "store add set.h5", "altered", ("set.h5",), "use the original", altered_array("set.h5", "slope")),
    Case("a set that the store does not have", "store show 0123456789", "not-found", ("0123456789",), "list them"),
    Case("a set's id too short", "store show 01", "not-found", ("01",), "list them"),
    Case("no set in force", "store lookup --serial D0001 --bit-depth 12", "not-found", ("D0001", "12 bits"), "certify one"),
    Case("a store that is no database", "store list", "store-damaged", ("store",), "restore it from a copy", written("../home/store.sqlite3", "not a database, but long enough to be looked at " * 30)),
)  # fmt: skip
