"""The rows of the table, by the name that picks them on the command line."""

from collections.abc import Callable

from benchmarks import (
    apply,
    calibration,
    diagnosis,
    line_fit,
    pairs,
    recording,
    simulation,
    sums,
    transfer_function,
    two_exposures,
)
from benchmarks.row import Row
from benchmarks.size import Size

ROWS: dict[str, Callable[[Size], Row]] = {
    "simulate": simulation.run,
    "sums": sums.one_thread,
    "sums-2": sums.two_threads,
    "covariances": sums.with_covariances,
    "moments": two_exposures.moments,
    "sanuc": two_exposures.reduction,
    "pairs": pairs.run,
    "fit": line_fit.run,
    "apply": apply.without_std,
    "apply-std": apply.with_std,
    "record": recording.run,
    "calibrate-8": calibration.of_8_bits,
    "calibrate-12": calibration.of_12_bits,
    "diagnose": diagnosis.of_5_mpix,
    "diagnose-full": diagnosis.of_full_size,
    "mtf": transfer_function.run,
}
