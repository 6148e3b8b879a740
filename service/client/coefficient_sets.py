"""Coefficient sets: their lives, which one is in force, and radiance by one."""

import tempfile
from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from calib.arrays import RawLines
from service.api.answers.coefficient_set import SetAnswer, SetPage
from service.client.applied import AppliedLines
from service.client.link import Link
from service.client.packing import pieces

_PLACE = "/v1/coefficient-sets"
_NPY = {"Content-Type": "application/x-npy"}
_IN_MEMORY_BYTES = 1 << 26


class CoefficientSets:
    """`/v1/coefficient-sets`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def get(self, set_id: str) -> SetAnswer:
        """Show a set and its life."""
        return self._link.get(SetAnswer, f"{_PLACE}/{set_id}")

    def all(
        self,
        *,
        state: str | None = None,
        serial: str | None = None,
        band: str | None = None,
        recording: str | None = None,
    ) -> Iterator[SetAnswer]:
        """Yield every set, newest first."""
        return self._link.pages(
            SetPage, _PLACE, state=state, serial=serial, band=band, recording=recording
        )

    def lookup(
        self,
        *,
        serial: str,
        bit_depth: int,
        band: str = "",
        gain_db: float = 0.0,
        region: str | None = None,
        at: datetime | None = None,
    ) -> SetAnswer:
        """Return the set that is in force for a camera's setting at a time; now where None."""
        when = None if at is None else at.isoformat()
        return self._link.get(
            SetAnswer, f"{_PLACE}/lookup", serial=serial, bit_depth=bit_depth, band=band,
            gain=gain_db, region=region, at=when,
        )  # fmt: skip

    def verify(self, set_id: str, *, reason: str = "") -> SetAnswer:
        """Say that a draft was looked at."""
        return self._link.post(SetAnswer, f"{_PLACE}/{set_id}/verify", {"reason": reason})

    def certify(
        self,
        set_id: str,
        *,
        valid_from: datetime,
        reason: str,
        valid_until: datetime | None = None,
        supersedes: Sequence[str] = (),
    ) -> SetAnswer:
        """Certify a verified set for a time, `valid_until` excluded.

        Raises:
            ProblemError: `overlapping-certification`; its `standing` names what to supersede.
        """
        said = {
            "valid_from": valid_from.isoformat(),
            "valid_until": None if valid_until is None else valid_until.isoformat(),
            "reason": reason,
            "supersedes": list(supersedes),
        }
        return self._link.post(SetAnswer, f"{_PLACE}/{set_id}/certify", said)

    def revoke(self, set_id: str, *, reason: str) -> SetAnswer:
        """Say that a set was wrong."""
        return self._link.post(SetAnswer, f"{_PLACE}/{set_id}/revoke", {"reason": reason})

    def download(self, set_id: str, out: Path | str) -> Path:
        """Write a set's file."""
        return self._link.download(f"{_PLACE}/{set_id}/file", out)

    def apply(
        self,
        set_id: str,
        lines: RawLines,
        *,
        exposure_us: float,
        at: datetime | None = None,
        serial: str | None = None,
        band: str | None = None,
        gain_db: float | None = None,
        black_level_dn: float | None = None,
        bit_depth: int | None = None,
        first_column: int | None = None,
        temperature_c: float | None = None,
        force: bool = False,
    ) -> AppliedLines:
        """Return the radiance of raw lines.

        What is None is taken to be as in the set, and `notes` say so.

        Args:
            set_id: The set.
            lines: (n_lines, n_columns) uint8 or uint16, DN.
            exposure_us: At which they were taken.
            at: When; a certified set holds for a time.
            serial: Of the camera.
            band: Of the camera.
            gain_db: Of the camera.
            black_level_dn: Of the camera.
            bit_depth: Of the lines.
            first_column: Where they begin on the sensor.
            temperature_c: Of the sensor.
            force: Whether a set that does not match is applied all the same; `flags` tell.
        """
        taken = {
            "exposure_us": exposure_us, "at": None if at is None else at.isoformat(),
            "serial": serial, "band": band, "gain": gain_db, "black_level": black_level_dn,
            "bit_depth": bit_depth, "first_column": first_column, "temperature": temperature_c,
            "force": force,
        }  # fmt: skip
        return self._applied(f"{_PLACE}/{set_id}/apply", lines, taken)

    def _applied(self, place: str, lines: RawLines, taken: dict[str, Any]) -> AppliedLines:
        with tempfile.TemporaryFile() as body, _spool() as answer:
            np.save(body, lines)
            body.seek(0)
            self._link.receive(
                answer, "POST", place, params=taken, headers=_NPY, content=pieces(body)
            )
            answer.seek(0)
            return AppliedLines.read(answer)


def _spool() -> "tempfile.SpooledTemporaryFile[bytes]":
    return tempfile.SpooledTemporaryFile(max_size=_IN_MEMORY_BYTES)
