from dataclasses import replace
from functools import cache

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.heldout import HeldOutDeviances, blocks_of, exposures_of, levels_of
from calib.diagnosis.naming.model import Model
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.level_nonadditivity import LevelNonadditivity
from calib.forward.effects.nonlinearity import Nonlinearity
from tests.calib.diagnosis.recordings import plain_model, plan, recorded


def recording(*effects: Effect) -> Evidence:
    rng = default_rng()
    return recorded(plain_model(96), plan(rng, 120, twice=2), rng, effects)


@cache
def bent() -> Evidence:
    return recording(Nonlinearity(2e-6))


def fitted(kind: type[Departure], evidence: Evidence) -> Model:
    """Return the model in which `kind`, in its plainest shape, is all there is."""
    responder = responder_of(evidence)
    one = signature(shapes_of(kind, scales_of(evidence, responder))[0], evidence, responder)
    assert one is not None
    contest, nothing = Contest((one,), evidence, responder), beside(None, evidence)
    return contest.placed(nothing, None, contest.ranking(nothing)[0])


def test_what_is_left_out_has_no_weight_and_all_else_keeps_its_own() -> None:
    evidence, gone = bent(), np.array([1, 4])
    fold = evidence.without_blocks(gone)
    kept = np.ones(evidence.n_blocks, bool)
    kept[gone] = False
    alone = replace(fold, of_all=None)
    for one, other in ((fold.pooled.std, alone.pooled.std), (fold.onset_std, alone.onset_std)):
        assert np.array_equal(one[kept], other[kept])
    assert np.isinf(fold.pooled.std[gone]).all()
    one, other = fold.rare_space.weights, alone.rare_space.weights
    assert np.array_equal(one[:, kept], other[:, kept])


def test_each_block_is_left_out_once() -> None:
    table = bent().table
    for folds, all_of_them in (
        (blocks_of(bent()), set(range(bent().n_blocks))),
        (exposures_of(bent()), set(range(bent().n_blocks))),
        (levels_of(bent()), set(np.flatnonzero(~table.dark).tolist())),
    ):
        assert sorted(np.concatenate(folds).tolist()) == sorted(all_of_them)
    for fold in exposures_of(bent()):
        assert len(set(table.exposure_us[fold])) == 1


def test_of_clean_recordings_each_number_left_out_adds_one_on_average() -> None:
    """The deviance of n numbers that are as predicted is n, and scatters by sqrt(2 n)."""
    surprises = []
    for rng in default_rng().spawn(3):
        evidence = recorded(plain_model(384), plan(rng, 40, twice=2), rng)
        clean = HeldOutDeviances(beside(None, evidence), evidence).of(())
        # Means that are predicted by the same three quarters err together.
        surprises.append((clean.deviance - clean.dof) / (np.sqrt(2.0 * clean.dof) * 4.0 / 3.0))
    assert abs(np.mean(surprises)) < 5.0 / np.sqrt(3.0)


def test_a_right_name_predicts_exposures_and_levels_that_it_did_not_see() -> None:
    model = fitted(Nonlinearity, bent())
    for folding in ("blocks", "exposures", "levels"):
        assert HeldOutDeviances(model, bent(), folding).gain(0) > 0.0


def test_a_wrong_name_predicts_less_than_the_right_one() -> None:
    for folding in ("exposures", "levels"):
        right, wrong = (
            HeldOutDeviances(fitted(kind, bent()), bent(), folding).gain(0)
            for kind in (Nonlinearity, LevelNonadditivity)
        )
        # A gain G scatters by 2 sqrt(G).
        assert right - wrong > 5.0 * 2.0 * np.sqrt(right)
