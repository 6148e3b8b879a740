"""By how much differences between names count where signatures are not exact."""

TEMPLATE_ERROR = 0.03
"""By how much of its length a fitted signature errs, in any direction that parts two names."""


def temper(gain: float, error: float = TEMPLATE_ERROR) -> float:
    """Return by which factor differences of deviance count, of a finding that explains `gain`.

    Two names part by the deviance D = d^2, d the distance of their signatures. Were these exact,
    the difference of what they explain would scatter by 2 d. A signature of length sqrt(gain) that
    errs by a share e of its length moves the difference by another 2 d e sqrt(gain): the
    logarithm of the odds, D of variance 4 D (1 + e^2 gain), is D / (1 + e^2 gain).
    """
    return 1.0 / (1.0 + error**2 * max(gain, 0.0))
