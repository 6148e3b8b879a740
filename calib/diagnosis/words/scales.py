"""The sizes of a recording that sentences refer to."""

from dataclasses import dataclass

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence


@dataclass(frozen=True)
class RecordingScales:
    """How long, how bright, how wide a recording is.

    Attributes:
        duration_s: From its start to the start of its last block.
        longest_us: The longest exposure.
        signal_dn: The largest mean signal of a block.
        signal_e: The same in electrons; 0 where the system gain is not known.
        gain_dn_per_e: The mean system gain; 0 where it is not known.
        least_radiance, most_radiance: Of the flats.
        rows, columns: Of the sensor.
        full_scale_dn: Its largest code.
    """

    duration_s: float
    longest_us: float
    signal_dn: float
    signal_e: float
    gain_dn_per_e: float
    least_radiance: float
    most_radiance: float
    rows: int
    columns: int
    full_scale_dn: int

    @classmethod
    def of(cls, evidence: Evidence, gain_dn_per_e: float) -> "RecordingScales":
        """Return those of a recording, with a system gain that was fitted to it."""
        table = evidence.table
        lit = table.radiance[table.radiance > 0]
        signal = max(float(evidence.signal_dn.max()), 0.0)
        return cls(
            float(np.ptp(table.started_s)) or 1.0,
            float(table.exposure_us.max()),
            signal,
            signal / gain_dn_per_e if gain_dn_per_e > 0 else 0.0,
            gain_dn_per_e,
            float(lit.min()) if len(lit) else 1.0,
            float(lit.max()) if len(lit) else 1.0,
            evidence.sensor.n_rows,
            evidence.sensor.n_columns,
            evidence.sensor.camera.full_scale_dn,
        )
