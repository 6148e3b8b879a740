import numpy as np
from numpy.random import default_rng

from calib.diagnosis.naming.judgement import HELD, Explained, told
from calib.diagnosis.signatures.template_error import temper
from tests.calib.diagnosis.probabilities import Found, fit, reliability

ERROR = 0.05


def free(deviances: dict[str, float]) -> dict[str, Explained]:
    """Return names without a price."""
    return {name: Explained(deviance, 0.0) for name, deviance in deviances.items()}


def findings(n: int) -> list[Found]:
    """Return findings of two names, whose signatures err by `ERROR` of their length."""
    rng = default_rng()
    found = []
    for _ in range(n):
        gain = float(np.exp(rng.uniform(np.log(50.0), np.log(20_000.0))))
        apart = gain * float(rng.uniform(0.0, 0.1))
        scatter = 2.0 * np.sqrt(apart * (1.0 + ERROR**2 * gain))
        ahead = apart + scatter * float(rng.standard_normal())
        found.append(Found(free({"true": gain, "false": gain - ahead}), gain, "true"))
    return found


def test_the_error_of_signatures_is_found_from_how_names_compare() -> None:
    error, off = fit(findings(1500))
    assert off < 0.3
    # In five of its standard uncertainties, and half a step of the grid.
    assert abs(np.log(error / ERROR)) < 5.0 * off + 0.03


def test_probabilities_are_kept_where_signatures_err_as_is_believed() -> None:
    for stated, right in reliability(findings(3000), ERROR):
        std = np.sqrt(max(stated * (1.0 - stated), 1e-3) / right.n)
        # Names that are not told were improbable: half a per cent at most.
        assert abs(right.value - stated) < 5.0 * std + 0.005


def test_names_are_told_until_they_make_up_nearly_all_and_three_at_most() -> None:
    alone = told(free({"a": 100.0, "b": 60.0, "c": 50.0}), 1.0)
    assert [each.effect for each in alone] == ["a"]
    alike = told(free({"a": 100.0, "b": 99.0, "c": 98.0, "d": 97.0}), 1.0)
    assert [each.effect for each in alike] == ["a", "b", "c"]
    assert told(free({"a": 100.0, "b": 0.0}), 1e-6)[1].probability > 0.49


def test_names_that_explain_far_less_have_no_probability_however_strong_the_finding_is() -> None:
    gain = 2.4e7
    nets = {"adc_dnl": gain, "stuck_bit": 0.7 * gain, "lamp_drift": 30.0, "cti": -np.inf}
    found = told(free(nets), temper(gain))
    assert [each.effect for each in found] == ["adc_dnl"]
    assert found[0].probability > HELD


def test_a_name_that_needs_more_freedom_is_less_likely_however_coarse_signatures_are() -> None:
    gain = 1e6
    dear, cheap = Explained(gain, 48.0), Explained(gain, 12.0)
    found = told({"dear": dear, "cheap": cheap}, temper(gain))
    assert found[0].effect == "cheap"
    assert found[0].probability > HELD


def test_a_number_for_each_pixel_is_paid_out_of_what_it_explains() -> None:
    gain, pixels = 60_000.0, 2000
    rates = Explained(gain, 2.0 * pixels, float(pixels))
    worse = Explained(gain - 2.0 * pixels - 5000.0, 0.0)
    # 5,000 less, after the price: a 55th of it counts, 91, and odds of exp(45).
    assert told({"rates": rates, "worse": worse}, temper(gain))[0].effect == "rates"
    better = Explained(gain - 2.0 * pixels + 1000.0, 0.0)
    assert told({"rates": rates, "better": better}, temper(gain))[0].effect == "better"
    # Where signatures are exact it costs what it has cost.
    assert rates.price_at(1.0) == rates.price
