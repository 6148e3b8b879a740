"""Which of `calibrate`'s options for radiances go together; light, for it runs before all else."""

from collections.abc import Sequence
from pathlib import Path

import typer


def check_together(
    table: Path | None,
    lamp_spectra: Path | None,
    response: Path | None,
    *,
    relative: bool,
    only_spectra: Sequence[float | None],
) -> None:
    """Raise typer.BadParameter, wrong usage, where the options contradict one another.

    `only_spectra` are those that mean something with --lamp-spectra alone, None where not given.
    """
    if (lamp_spectra is None) != (response is None):
        msg = "--lamp-spectra and --spectral-response are given together, or not at all"
        raise typer.BadParameter(msg)
    if lamp_spectra is not None and table is not None:
        msg = "radiances come from --radiances or from --lamp-spectra, not from both"
        raise typer.BadParameter(msg)
    if lamp_spectra is not None and relative:
        raise typer.BadParameter("--relative does without radiances, --lamp-spectra gives them")
    if lamp_spectra is None and any(each is not None for each in only_spectra):
        msg = "--certificate-std and --response-correlation-nm go with --lamp-spectra"
        raise typer.BadParameter(msg)
