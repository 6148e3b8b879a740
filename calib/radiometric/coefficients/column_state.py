"""Why a column can, or cannot, be calibrated."""

from enum import IntEnum


class ColumnState(IntEnum):
    """The reason code of a column; anything but VALID masks it. Masked is never interpolated."""

    VALID = 0
    DEAD = 1
    """Sends one code whatever happens: no temporal noise and no response in any block."""
    HOT = 2
    """Its offset or its dark current stands far above what its fellows show."""
    SATURATED = 3
    """Fewer blocks than a line needs lie between the two ends of the code range."""
    NEVER_LIT = 4
    """Lives (its noise is seen), but does not respond to light as its neighbours do."""
    NOT_FITTED = 5
    """Clipped at black in too many blocks, so that no line can be laid through the rest."""
