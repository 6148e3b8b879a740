"""How runs answer what they cannot do."""

from calib.errors import DarkflatError


class BenchHeldError(DarkflatError):
    """Somebody else has the bench."""

    def __init__(self, holder: str) -> None:
        super().__init__(
            f"the bench is held by {holder}; wait until the run ends, ask them, or switch all lamps"
            " off with safe-off, which everybody may",
            code="bench-held",
        )
