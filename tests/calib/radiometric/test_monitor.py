"""A monitor that follows the source corrects the blocks' light; one that does not, does nothing."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.recording.block_statistics import RecordingStatistics
from tests.calib.radiometric.simulated import Bench, draw
from tests.calib.radiometric.test_coverage import cover

SWEEP = tuple(np.linspace(50.0, 500.0, 12))
DRIFTING = Bench(exposures=SWEEP, levels=(), drift=0.03, monitor_noise=2e-4)
RESTLESS = Bench(exposures=SWEEP, unrest=0.01, monitor_noise=3e-4)


def determined(
    bench: Bench, rng: np.random.Generator, choices: Choices | None = None
) -> Determined:
    return determine(draw(bench, rng).statistics, bench.header(), Provenance("0" * 64), choices)


def verdict(found: Determined) -> object:
    return found.coefficients.provenance.parameters["monitor"]


@pytest.mark.parametrize("bench", [DRIFTING, RESTLESS], ids=["drift", "unrest"])
def test_what_a_monitor_corrected_scatters_as_stated(bench: Bench) -> None:
    cover(bench, default_rng(), 80).check(0.1)


@pytest.mark.soak
@pytest.mark.parametrize("bench", [DRIFTING, RESTLESS], ids=["drift", "unrest"])
def test_what_a_monitor_corrected_scatters_as_stated_over_many_recordings(bench: Bench) -> None:
    cover(bench, default_rng(), 1000).check(0.1)


def test_a_drift_is_taken_off_the_offsets_and_said() -> None:
    errors = {"use": [], "ignore": []}
    for seed in range(20):
        for choice, found in errors.items():
            drawn = draw(DRIFTING, default_rng(seed))
            got = determine(
                drawn.statistics, DRIFTING.header(), Provenance("0" * 64), Choices(monitor=choice)
            )
            found.append(np.mean(got.coefficients.dark_offset_dn - drawn.offset))
            assert verdict(got) == {"use": "used", "ignore": "ignored"}[choice]
            assert any("corrected by its reading" in w for w in got.warnings) == (choice == "use")
    # A signal of 2,400 DN that gains 3 % on the way is bent; the line's intercept falls by a sixth
    # of that 80 DN where all exposures count alike, and by less where the dim ones count more.
    assert abs(np.mean(errors["ignore"])) > 5.0
    assert abs(np.mean(errors["use"])) < 4 * np.std(errors["use"]) / np.sqrt(20) + 0.1


def test_what_is_left_of_the_unrest_is_what_the_monitor_gets_wrong() -> None:
    bench = replace(RESTLESS, monitor_noise=0.002)
    left = [determined(bench, rng).figures.source_unrest for rng in default_rng(5).spawn(40)]
    square = np.square(left)
    assert abs(square.mean() - 0.002**2) < 4 * square.std() / np.sqrt(len(square))


def test_a_monitor_that_does_not_follow_is_not_used() -> None:
    """Its noise would be put into the light; one in a thousand may follow by chance."""
    bench = replace(RESTLESS, monitor_noise=None)
    for rng in default_rng(6).spawn(30):
        statistics = draw(bench, rng).statistics
        blind = [
            replace(s, block=s.block.model_copy(update={"monitor": 1e-6 * (1 + 0.01 * x)}))
            for s, x in zip(statistics.fit, rng.standard_normal(len(statistics.fit)), strict=True)
        ]
        got = determine(RecordingStatistics(tuple(blind)), bench.header(), Provenance("0" * 64))
        plain = determine(statistics, bench.header(), Provenance("0" * 64))
        assert verdict(got) == "not followed"
        assert any("do not follow" in w for w in got.warnings)
        np.testing.assert_array_equal(got.coefficients.slope, plain.coefficients.slope)


def test_one_flat_without_a_reading_leaves_the_monitor_out() -> None:
    statistics = draw(RESTLESS, default_rng(7)).statistics
    first = statistics.fit[0]
    unread = replace(first, block=first.block.model_copy(update={"monitor": None}))
    some = RecordingStatistics((unread, *statistics.fit[1:]))
    assert verdict(determine(some, RESTLESS.header(), Provenance("0" * 64))) == "none"


def test_too_few_blocks_do_not_test_a_monitor() -> None:
    bench = Bench(exposures=(100.0, 300.0), levels=(), unrest=0.01, monitor_noise=1e-4)
    assert verdict(determined(bench, default_rng(8))) == "not testable"


def test_a_choice_that_is_none_is_refused() -> None:
    with pytest.raises(InputError) as refusal:
        determined(Bench(), default_rng(9), Choices(monitor="perhaps"))  # type: ignore[arg-type]
    assert refusal.value.code == "bad-monitor"
