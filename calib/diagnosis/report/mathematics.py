"""The mathematics behind a diagnosis, short: model, statistics, thresholds, sources."""

import inspect
from collections.abc import Sequence

from calib.diagnosis.answer.diagnosis import AMBIGUOUS
from calib.diagnosis.naming.heldout import FOLDS
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA
from calib.diagnosis.naming.search import THRESHOLD
from calib.diagnosis.words.verdict import spoken
from calib.forward.departure import Departure

Lines = tuple[tuple[str, str], ...]
"""Paragraphs, each "formula" or "quiet" or plain."""

MODEL: Lines = (
    ("formula", "DN = L·VE·QE·t + DN0, for each pixel; variance = K·(mean − DN0) + read noise²"),
    (
        "",
        "L radiance, VE vignette, QE responsivity, t exposure, DN0 dark offset, K system gain, one "
        "per tap; then rounding and clipping. All are fitted to the recording, and fitted anew "
        "beside what was found. Source: Olsen et al., Radiometric calibration for AgCam (2010), "
        "Equation 1; EMVA Standard 1288, Release 4.0 Linear, for the noise.",
    ),
)
STATISTICS: Lines = (
    (
        "",
        "Each block gives means by pixel; variances, kurtosis and covariances of columns (1 to 4 "
        "apart), rows and lines (1 and 2 apart), pooled by tap and quarter of the columns; "
        "variances and covariances of the lines' means; a spectrum; the first three lines; the "
        "histogram of codes; counts of what stands out. Their covariance is that of independent "
        "pixels, and of noise that a line's pixels share.",
    ),
    (
        "formula",
        "signature of an effect: s = W (S(model with it) − S(model without)), "
        "same random numbers in both",
    ),
    (
        "",
        "W whitens and takes off what offsets, slopes, gains and read noise absorb. An effect "
        "explains the deviance (s·r)² / s·s of a remainder r; parameters are fitted jointly by "
        "Gauss and Newton, and their uncertainties are the inverse of the normal matrix.",
    ),
)


def mathematics(effects: Sequence[Departure]) -> tuple[tuple[str, Lines], ...]:
    """Return headings with their paragraphs; effects with formula and source."""
    told = tuple(
        line
        for effect in effects
        for line in (
            ("", f"{spoken(effect.name)}: {effect.physics}"),
            ("quiet", f"Source: {source_of(type(effect))}"),
        )
    )
    thresholds: Lines = (
        (
            "",
            f"An effect is added where it explains a deviance above {THRESHOLD:.1f} after a "
            "penalty of 2 ln(shapes tried). A finding is ambiguous where a second name has a "
            f"probability of {100 * AMBIGUOUS:g} % or more. A remainder beyond "
            f"{CERTAIN_SIGMA:g} σ, all ways of looking counted, is called unexplained. Deviance "
            "on what the fit did not see: minus twice the log predictive density of blocks left "
            f"out, in {FOLDS} folds.",
        ),
    )
    parts = [("The plain model", MODEL), ("How it is compared", STATISTICS)]
    if told:
        parts.append(("What was found", told))
    return (*parts, ("Thresholds", thresholds))


def source_of(kind: type[Departure]) -> str:
    """Return where an effect's physics is from, as its file says."""
    text = inspect.getdoc(inspect.getmodule(kind)) or ""
    _, _, source = text.partition("Source: ")
    return " ".join(source.split("\n\n")[0].split()) or "see its file"
