"""How a run ends early."""

from calib.errors import DarkflatError


class RunCancelledError(Exception):
    """Somebody asked the run to end; it is no fault."""


class RunRefusedError(DarkflatError):
    """The run was not begun: the plan, the bench and the recording do not fit together."""


class InterlockError(DarkflatError):
    """A condition left the range in which the plan may go on; code `interlock`."""


class NotSettledError(DarkflatError):
    """The light did not become steady in time; code `light-not-settled`."""


class SaturationAheadError(DarkflatError):
    """The next block would saturate and the plan says to stop; code `saturation-ahead`."""
