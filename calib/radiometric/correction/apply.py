"""Raw lines into radiance, with its standard uncertainty and a quality flag per pixel.

Source: Olsen et al. 2010 (AgCam), Eq. 1 solved for L. See `apply_terms` for the uncertainty.
"""

from datetime import datetime
from functools import reduce
from math import ceil, floor, sqrt
from typing import cast

import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError
from calib.kernels import radiance as kernel
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply_checks import (
    Validity,
    domain_findings,
    mismatches,
    refuse,
    validity_findings,
)
from calib.radiometric.correction.apply_terms import column_terms
from calib.radiometric.correction.flags import Flag
from calib.radiometric.correction.inversion import Inversion
from calib.radiometric.correction.inverted_lines import fill_inverted
from calib.radiometric.correction.radiance_lines import Radiance
from calib.radiometric.correction.transmittance import Window
from calib.recording.header import CameraHeader

_CODES = (np.dtype(np.uint8), np.dtype(np.uint16))
LEAST_US, MOST_US = 1e-6, 1e12
"""Exposures that any light is taken with, with room: their numbers fit single precision."""
_NO_WINDOW = Window(1.0, 0.0, "none")


class Correction:
    """A coefficient set made ready for one camera setting.

    Attributes:
        coefficients: The set.
        terms: What it says of each column at this exposure (`ColumnTerms`).
        window: What the scene was seen through; its transmittance is 1 where there was none.
        notes: What a reader of the result has to know: mismatches that were forced, extrapolation.
        flags: The bits that every sample carries because of `notes`.
        inversion: What takes the set's departures out of lines; None where it has none. Calls of
            `lines` are then taken to be for successive lines.
    """

    def __init__(
        self,
        coefficients: CoefficientSet,
        exposure_us: float,
        *,
        camera: CameraHeader,
        at: datetime | None = None,
        validity: Validity | None = None,
        window: Window | None = None,
        sensor_temperature_c: float | None = None,
        force: bool = False,
        follows: "Correction | None" = None,
    ) -> None:
        """Check that `coefficients` hold for these lines.

        Args:
            coefficients: The set.
            exposure_us: Exposure time of the lines.
            camera: That of the lines. A serial or band that it does not state does not match.
            at: When the lines were taken; `camera.started_at` where None.
            validity: The range for which the set is certified; not checked where None.
            window: What was between scene and camera, but not so during the calibration.
            sensor_temperature_c: The sensor's temperature; not checked where None.
            force: Apply the set although it does not match, and say so in flags and notes.
            follows: What corrected the lines before these, where a departure of the set, such as
                lag, has memory; None takes the sensor to have rested.

        Raises:
            InputError: `set-mismatch` or `outside-validity` (unless forced), `wrong-columns`,
                `bad-exposure`.
        """
        if camera.columns != coefficients.n_columns:
            msg = (
                f"The set has {coefficients.n_columns} columns, the lines {camera.columns}: take "
                "the set that was calibrated with the same region."
            )
            raise InputError(msg, code="wrong-columns")
        if not LEAST_US <= exposure_us <= MOST_US:
            msg = (
                f"An exposure of {exposure_us:g} µs cannot be corrected: state it above 0, between"
                f" {LEAST_US:g} and {MOST_US:g} µs."
            )
            raise InputError(msg, code="bad-exposure")
        at = camera.started_at if at is None else at
        against = mismatches(coefficients, camera) + validity_findings(validity, at)
        if not force:
            refuse(against)
        findings = against + domain_findings(coefficients, exposure_us, sensor_temperature_c)
        self.coefficients = coefficients
        self.camera = camera
        self.window = _NO_WINDOW if window is None else window
        self.terms = column_terms(
            coefficients, exposure_us, self.window.relative_std, self.window.transmittance
        )
        self.notes = tuple(finding.text for finding in findings)
        before = None if follows is None else follows.inversion
        self.inversion: Inversion | None = Inversion.of(
            coefficients, exposure_us, camera, at=at, temperature_c=sensor_temperature_c,
            follows=before,
        )  # fmt: skip
        if self.inversion is not None:
            self.notes += self.inversion.notes
        self.flags = reduce(Flag.__or__, (finding.flag for finding in findings), Flag(0))
        masked = np.where(coefficients.valid, 0, int(Flag.MASKED))
        self._base = (masked | int(self.flags)).astype(np.uint8)
        self._single = self.terms.in_single_precision()
        self._limits_dn = self._extrapolation_limits()

    def lines(self, dn: RawLines, *, out: Radiance | None = None, std: bool = True) -> Radiance:
        """Return the radiance of raw lines.

        Args:
            dn: (n_lines, n_columns) uint8 or uint16.
            out: Arrays to fill and return; reuse them in a stream, for fresh memory costs more
                than the correction.
            std: Whether the uncertainty is wanted; with `out`, what it has is filled.

        Raises:
            InputError: `wrong-shape` or `wrong-dtype`.
        """
        self._check(dn)
        codes = cast("RawLines", np.ascontiguousarray(dn))
        result = Radiance.empty(*codes.shape, std=std) if out is None else out
        result.check_fits(codes)
        if self.inversion is None:
            kernel.correct(
                codes,
                self._single,
                self._limits_dn,
                self._base,
                (result.radiance, result.std, result.flags),
            )
        else:
            fill_inverted(
                codes,
                self.inversion,
                terms=self.terms,
                limits_dn=self._limits_dn,
                base_flags=self._base,
                out=(result.radiance, result.std, result.flags),
            )
        return result

    def mean_line(self, dn: RawLines) -> Radiance:
        """Return the mean over lines of one radiance, (1, n_columns), with its uncertainty.

        The temporal noise falls with the number of lines, the coefficients' and the scale's does
        not. A saturated sample makes its column's std infinite; flags are those of any line.
        """
        self._check(dn)
        single = self.lines(dn)
        terms, n_lines = self.terms, len(dn)
        signal = dn.mean(axis=0, dtype=np.float64) - terms.dark_dn
        if self.inversion is not None:
            signal = single.radiance.mean(axis=0, dtype=np.float64) / terms.scale
        temporal = terms.temporal_variance_dn2(signal) / n_lines
        std = np.sqrt(temporal + terms.coefficient_variance_dn2(signal)) * terms.scale
        flags = np.bitwise_or.reduce(single.flags, axis=0)
        std[(flags & Flag.SATURATED != 0) & np.isfinite(std)] = np.inf
        return Radiance(
            (signal * terms.scale)[None, :].astype(np.float32),
            std[None, :].astype(np.float32),
            flags[None, :],
        )

    def _check(self, dn: RawLines) -> None:
        if dn.dtype not in _CODES:
            msg = f"Raw lines are uint8 or uint16, not {dn.dtype}."
            raise InputError(msg, code="wrong-dtype")
        if dn.ndim != 2 or dn.shape[1] != self.coefficients.n_columns or dn.shape[0] == 0:
            msg = f"Lines of shape {dn.shape} are not (n_lines, {self.coefficients.n_columns})."
            raise InputError(msg, code="wrong-shape")

    def _extrapolation_limits(self) -> tuple[int, int, int]:
        """Return the lowest and highest code that is not extrapolated, and full scale."""
        lowest, highest = self.coefficients.domain.dn
        full_scale = self.camera.full_scale_dn
        noise = float(np.median(self.terms.noise_dn2))

        def reach(level: float) -> float:
            return 3.0 * sqrt(noise + self.terms.gain * max(level, 0.0))

        return ceil(lowest - reach(lowest)), floor(highest + reach(highest)), full_scale
