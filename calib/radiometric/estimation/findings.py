"""What a bench operator should know about a calibration, one sentence each."""

from collections.abc import Iterator

import numpy as np

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.estimation.dark_comparison import DarkComparison
from calib.radiometric.estimation.dark_current import CURRENT_SIGMA, DarkCurrent
from calib.radiometric.estimation.excess import variance_factor
from calib.radiometric.estimation.parts import Parts
from calib.radiometric.estimation.scale import RadianceScale
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.rounding import INVERTIBLE_SIGMA_DN, NEGLIGIBLE_SIGMA_DN

DIFFERENT_SIGMA = 4.0
UNREST_SIGMA = 5.0


def set_findings(coefficients: CoefficientSet, relative: bool) -> Iterator[str]:
    """Yield what the set itself gives reason to say."""
    counts = [(s, int((coefficients.reason == s).sum())) for s in ColumnState]
    masked = [f"{n} {s.name.lower().replace('_', ' ')}" for s, n in counts if s and n]
    if masked:
        yield f"Masked columns: {', '.join(masked)}."
    if coefficients.axis_column_std is None:
        yield (
            "The vignette has no clear maximum inside the line: the axis column is only where it "
            "is largest."
        )
    if relative:
        yield "The scale is relative: radiance 1 is that of the reference level."
    if not coefficients.system_gain_dn_per_e > 0:
        yield "No shot noise is seen, so that the system gain is not determined."


def line_findings(parts: Parts) -> Iterator[str]:
    """Yield what the columns' lines give reason to say."""
    estimate = parts.estimate
    chi2, freedom = parts.reduced_chi_squared, estimate.fit.freedom
    if freedom <= 0:
        yield (
            "Two exposures for two unknowns: whether the response is a line is not tested; record "
            "more exposures."
        )
    elif chi2 > 1.0 + 5.0 * np.sqrt(2.0 / freedom):
        yield (
            f"The lines do not fit within the noise (reduced chi-squared {chi2:.2f}): the "
            "response is not linear or the source was not steady. The report's residuals by block "
            "tell: what returns with the signal is the response, what goes with time the source."
        )
    yield from _unrest_findings(parts)
    smallest = float(np.sqrt(estimate.noise.read_variance_dn2))
    if smallest < INVERTIBLE_SIGMA_DN:
        yield (
            f"The noise in the dark is {smallest:.2f} DN: rounding does not average out, and "
            "what is left of it is counted as uncertainty."
        )
    elif smallest < NEGLIGIBLE_SIGMA_DN / 2.4:
        yield f"The noise in the dark is {smallest:.2f} DN: the bias of rounding was undone."
    yield from _current_findings(estimate.current)


def _unrest_findings(parts: Parts) -> Iterator[str]:
    """Yield what is known of the source's steadiness."""
    monitor, shared = parts.monitor, parts.shared
    if monitor.used:
        yield (
            f"The monitor wandered by {100 * monitor.wander:.2g} % within levels, the camera saw "
            f"{monitor.share:.2f} ± {monitor.share_std:.2g} of it, and the light of each block was "
            "corrected by its reading."
        )
    if shared.unrest_sigma > UNREST_SIGMA:
        yield (
            f"The source wandered by {100 * shared.source_unrest:.2g} % between blocks, if the "
            "response is a line and lines have no noise in common (darks repeated at one exposure "
            "would show that); this is counted as uncertainty. Let the source settle for longer."
        )
        if monitor.verdict == "not followed":
            yield "The monitor's readings do not follow this wandering and were not used."
    if parts.estimate.fit.freedom > 0 and shared.freedom < 1:
        yield "Whether the source was steady from block to block is not tested: too few blocks."
    elif shared.freedom in {1, 2}:
        yield (
            f"Only {shared.freedom} more blocks than unknowns tell how steady the source was: what "
            f"they tell is widened {_widened(shared.freedom)} times. Record more exposures."
        )


def _current_findings(current: DarkCurrent) -> Iterator[str]:
    """Yield what the dark current gives reason to say."""
    if current.mean_significance > CURRENT_SIGMA:
        mean = float(np.mean(current.dn_per_us))
        yield f"The dark grows by {mean:.3g} DN per µs on average; this was taken off the flats."
    if current.outstanding.any():
        most = float(current.dn_per_us[current.outstanding].max())
        yield (
            f"{int(current.outstanding.sum())} columns grow otherwise in the dark than the others, "
            f"by up to {most:.3g} DN per µs; this was taken off the flats."
        )


def dark_findings(darks: DarkComparison | None) -> Iterator[str]:
    """Yield what comparing darks with intercepts gives reason to say."""
    if darks is None:
        yield "No capped darks: the intercepts are not verified."
        return
    if darks.clipping_columns:
        yield (
            f"{darks.clipping_columns} columns clip at 0 in the dark: their capped mean is too "
            "high, and they are left out of the comparison with the regression."
        )
    if abs(darks.significance_sigma) > DIFFERENT_SIGMA:
        yield (
            f"Capped darks and intercepts differ by {darks.difference_dn:.3f} DN "
            f"({darks.significance_sigma:+.1f} sigma): stray light, a nonlinear response or an "
            "unsteady source."
        )


def source_findings(
    source: SourceUncertainty, scale: RadianceScale, relative: bool
) -> Iterator[str]:
    """Yield what is missing of the source, or at odds with it."""
    if source.certificate_relative_std is None and not relative:
        yield (
            "The uncertainty of the source's certificate is not stated and taken as 0: state "
            "certificate_relative_std under [source]."
        )
    yield from _not_stated(source, relative)
    stated = source.level_relative_std is not None
    if not (stated or relative):
        yield from _few_levels(scale)
    if stated and scale.scatter_sigma > DIFFERENT_SIGMA:
        yield (
            f"The levels' radiances disagree beyond what is stated ({scale.scatter_sigma:.1f} "
            "sigma): check the table of radiances and the linearity."
        )
    elif scale.level_relative_std > 0.02:
        yield (
            f"The levels' radiances scatter by {100 * scale.level_relative_std:.1f} % against "
            "what the camera sees: check the table of radiances and the linearity."
        )


def _not_stated(source: SourceUncertainty, relative: bool) -> Iterator[str]:
    """Yield what of the source's uncertainty nothing is known of, but for the certificate."""
    names = ["nonuniformity_relative"] if relative else [
        "nonuniformity_relative", "monitor_relative_std",
    ]  # fmt: skip
    missing = [name for name in names if getattr(source, name) is None]
    if missing:
        yield f"Not stated under [source] and taken as 0: {', '.join(missing)}."


def _few_levels(scale: RadianceScale) -> Iterator[str]:
    """Yield how little tells what a single level's radiance is worth, where that is not stated."""
    if scale.freedom < 1:
        yield (
            "How far the radiance of a single level may be off is not stated and taken as 0, since "
            "one level does not tell: state level_relative_std under [source]."
        )
    elif scale.freedom < 3:
        yield (
            f"Only {scale.freedom + 1} levels tell how far the radiance of a single one may be "
            f"off: what they tell is widened {_widened(scale.freedom)} times. State "
            "level_relative_std under [source], or record four levels."
        )


def _widened(freedom: int) -> str:
    return f"{np.sqrt(variance_factor(freedom)):.2g}"
