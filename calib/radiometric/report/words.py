"""What the report says in words, from the numbers."""

import math

from calib.radiometric.calibration import Calibration
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.header import RecordingHeader
from calib.report.style import unit_text

Rows = tuple[tuple[str, str], ...]


def source_line(header: RecordingHeader) -> str:
    """Return what lit it, and how much was taken."""
    kinds = [b.kind for b in header.blocks]
    lit = f"{header.source.kind}, {header.source.lamps} lamps"
    return f"{lit} · {kinds.count('flat')} flat and {kinds.count('dark')} dark blocks"


def lead(calibration: Calibration) -> tuple[str, ...]:
    """Return the first sentences: what was found, in an operator's words."""
    found, seen = calibration.coefficients, calibration.uniformity
    index = found.axis_index
    relative = 100.0 * found.responsivity_std[index] / found.responsivity[index]
    sentences = [
        f"{int(found.valid.sum())} of {found.n_columns} columns can be used. Radiance at the axis "
        f"is known to ±{2 * relative:.2g} % (k = 2), of which ±{200 * found.scale_relative_std:.2g}"
        " % is the radiance scale's."
    ]
    if found.departures is not None:
        names = " and ".join(n.replace("_", " ") for n in found.departures.taken_out)
        sentences.append(
            f"The model's {names} was taken out of the recording before anything was fitted, and "
            "is taken out of lines that this set corrects; the figures show what is left."
        )
    if seen is not None:
        sentences.append(
            f"A uniform source varied by {seen.before:.2f} % along the columns after the vignette "
            f"was divided out, and by {seen.after:.2f} % after the correction (mean of "
            f"{seen.n_lines} lines that the fit did not use, block {seen.block})."
        )
    return tuple(sentences)


def facts(calibration: Calibration) -> Rows:
    """Return the figures that a person asks for first."""
    found = calibration.coefficients
    index = found.axis_index
    axis = f"{found.axis_column:.1f}"
    if found.axis_column_std is not None:
        axis += f" ± {found.axis_column_std:.1f}"
    rows = [
        ("Mean dark offset DN0", f"{_mean_offset(calibration)} DN"),
        ("Axis column (0-based)", axis),
        ("Fall at the edge", f"{found.edge_fall_percent:.2f} %"),
        ("Order of the vignette", f"{found.vignette_order}"),
        (
            "Responsivity at the axis",
            f"{_with_std(found.responsivity[index], found.responsivity_std[index])} "
            f"DN / ({unit_text(found.radiance_unit)} µs)",
        ),
        ("System gain", _gain(found)),
        ("Read noise", f"{_with_std(found.read_noise_e, found.read_noise_e_std)} e⁻"),
    ]
    if found.departures is not None:
        rows.append(("Taken out", _departures(found)))
    if found.reduced_chi_squared is not None:
        rows.append(("Reduced χ² of the lines", f"{found.reduced_chi_squared:.3f}"))
    return tuple(rows)


def _departures(found: CoefficientSet) -> str:
    """Return the names of what was taken out, with its numbers."""
    told = found.departures.taken_out if found.departures else {}
    return "; ".join(
        f"{name} ({', '.join(f'{k} {v:g}' for k, v in table.items() if isinstance(v, float))})"
        for name, table in told.items()
    )


def _gain(found: CoefficientSet) -> str:
    return f"{_with_std(found.system_gain_dn_per_e, found.system_gain_dn_per_e_std)} DN/e⁻"


def _with_std(value: float, std: float) -> str:
    """Return a value with as many digits as its uncertainty, of which two are given."""
    if not (math.isfinite(value) and math.isfinite(std) and std > 0):
        return f"{value:.5g} ± {std:.2g}"
    digits = max(1 - math.floor(math.log10(std)), 0)
    return f"{value:.{digits}f} ± {std:.{digits}f}"


def _mean_offset(calibration: Calibration) -> str:
    mean = calibration.coefficients.summary()["mean_dark_offset_dn"]
    return _with_std(mean, calibration.figures.dark_offset_common_std_dn)


def provenance(found: CoefficientSet) -> Rows:
    """Return what makes the set repeatable."""
    source = found.provenance
    parameters = ", ".join(f"{k} = {v}" for k, v in source.parameters.items())
    rows = (
        ("Coefficient set", found.id),
        ("Recording", source.recording_name),
        ("Its digest", source.recording_digest),
        ("Started at", source.started_at),
        ("Method", source.method),
        ("Parameters", parameters),
        ("Radiance standard", source.radiance_standard),
        ("Certificate", source.certificate),
        *((("Taken out", _departures(found)),) if found.departures else ()),
        ("Software", f"darkflat {source.software_version}"),
    )
    return tuple((name, value or "not stated") for name, value in rows)
