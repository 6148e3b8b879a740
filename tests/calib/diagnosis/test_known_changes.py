import numpy as np

from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.simulation.latest import Latest
from calib.diagnosis.statistics.change import Change
from calib.forward.effects.lag import Lag
from calib.forward.effects.nonlinearity import Nonlinearity
from tests.calib.diagnosis.test_heldout import bent


def change(size: float) -> Change:
    return Change(*(np.full(4, size) for _ in range(9)))


def test_what_is_known_is_not_simulated_again_until_too_much_is() -> None:
    # Nine parts of four numbers of eight bytes: there is room for two.
    known = Latest[Change](lambda each: each.nbytes, 2 * 9 * 4 * 8)
    asked: list[str] = []

    def of(name: str) -> None:
        def simulated() -> Change:
            asked.append(name)
            return change(1.0)

        known.of(name, simulated)

    for name in ("a", "b", "a", "c", "a", "b"):
        of(name)
    assert asked == ["a", "b", "c", "b"]


def test_changes_of_other_effects_or_about_other_links_are_not_mistaken_for_each_other() -> None:
    evidence = bent()
    first = responder_of(evidence)
    base = evidence.baseline
    other = first.about(type(base)(**{**vars(base), "offset_dn": base.offset_dn + 1.0}))
    asked = [((Nonlinearity(2e-6),), first), ((Nonlinearity(4e-6),), first),
             ((Nonlinearity(2e-6),), other), ((), other)]  # fmt: skip
    before = [change_of(effects, evidence, responder) for effects, responder in asked]
    for k, (effects, responder) in enumerate(asked):
        again = change_of(effects, evidence, responder)
        assert again is before[k]
        fresh = responder_of(evidence)
        fresh = fresh if responder is first else fresh.about(responder.chain.baseline)
        for one, two in zip(
            again.parts(), change_of(effects, evidence, fresh).parts(), strict=True
        ):
            assert np.array_equal(one, two)
    assert len({id(each) for each in before}) == len(asked)


def test_lags_side_by_side_are_those_of_each_stretch_alone() -> None:
    chain = responder_of(bent()).chain
    lag, lines = Lag(0.05), np.arange(5.0)
    stack = chain.stack([(b, lines + b % 2) for b in range(len(chain.table.blocks))], "lines")
    rng = np.random.default_rng()
    lefts = [None if b == 0 else chain.left_after(b, 40, (lag,), None) for b in stack.blocks]
    stack = stack.before(lefts)
    signal = rng.uniform(50.0, 900.0, (stack.n_lines, *chain.sensor.sample))
    for noise in (1.0, -1.0, 0.0):
        together = chain.passage.through(lag, signal, stack, stack.at, 0, noise)
        for b, where, at in zip(stack.blocks, stack.parts, stack.at, strict=True):
            alone = chain.noise.of_effect(lag, (b,), 0, signal[where].shape, noise)
            assert np.array_equal(together[where], lag.apply(signal[where], at, alone))
