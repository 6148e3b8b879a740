"""What a coefficient set says of the camera's pixel transfer function: its file, by content."""

from dataclasses import dataclass

Pair = tuple[float | None, float | None]


@dataclass(frozen=True)
class TransferReference:
    """Names a transfer function and its scalar figures; along x (columns) and y (rows).

    Attributes:
        id: SHA-256 of the transfer function's arrays and metadata, as TF.h5 bears it.
        method: How it was estimated.
        pitch_um: The pixels' distance, µm.
        first_zero_per_mm: Where it first changes its sign; None along an axis without a zero.
        mtf_at_nyquist: |T| at 1/(2 pitch); None where the pattern does not determine it.
        mtf_at_nyquist_std: Its standard uncertainty.
    """

    id: str
    method: str
    pitch_um: float
    first_zero_per_mm: Pair
    mtf_at_nyquist: Pair
    mtf_at_nyquist_std: Pair
