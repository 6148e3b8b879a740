from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.random import default_rng

from calib.arrays import Columns
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.scene_light import has_known_light, steady_images
from calib.forward.model import Model
from calib.recording.header import Block, CameraHeader, RecordingHeader
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

SENSORS = {
    "line": lambda: plain_model(128),
    "odd and even": lambda: plain_model(128, taps=2, layout="odd_even"),
    "quadrants": lambda: plain_model(32, taps=4, layout="quadrants", rows=16),
    "quarters": lambda: plain_model(128, bits=14, taps=4, layout="quarters"),
}


def evidence_of_clean(model: Model) -> list[Evidence]:
    return [recorded(model, plan(rng, 60), rng) for rng in default_rng().spawn(4)]


@pytest.mark.parametrize("sensor", SENSORS)
def test_what_the_baseline_expects_is_what_clean_recordings_show(sensor: str) -> None:
    """Each statistic's z has mean 0 and standard deviation 1, pooled over blocks and recordings."""
    many = evidence_of_clean(SENSORS[sensor]())
    for kind in many[0].pooled.places:
        z = []
        for evidence in many:
            std = evidence.pooled.std[:, evidence.pooled.places[kind]]
            observed = evidence.observed().pooled[:, evidence.pooled.places[kind]]
            fine = np.isfinite(std) & (std > 0)
            z.append(observed[fine] / std[fine])
        pooled = np.concatenate(z)
        if len(pooled) == 0:
            continue
        # Twelve kinds on four sensors: 5 standard errors are exceeded once in 30,000 runs. Chi-
        # squared statistics of line means are skewed, and gain and read noise were fitted.
        assert abs(pooled.mean()) < 5.0 / np.sqrt(len(pooled)), kind
        allowed = 5.0 / np.sqrt(2 * len(pooled)) + 0.07
        assert pooled.std() - 1.0 < allowed, kind
        # Kurtosis allows for single samples that nearly stand out, of which clean noise has none.
        assert kind == "kurtosis" or pooled.std() - 1.0 > -allowed, kind


def test_means_scatter_as_much_as_their_weights_say() -> None:
    for evidence in evidence_of_clean(plain_model(128)):
        point = evidence.point(evidence.observed())
        freedom = evidence.space.degrees_of_freedom
        assert abs(float((point.means**2).sum()) - freedom) < 5.0 * np.sqrt(2.0 * freedom)


def test_what_changes_in_one_kind_of_statistic_has_its_length_there_alone() -> None:
    rng = default_rng()
    evidence = recorded(plain_model(128), plan(rng, 60), rng)
    seen = evidence.observed()
    whole = evidence.whitening.energies(evidence.point(seen))
    assert sum(whole.values()) == pytest.approx(evidence.product(*(evidence.point(seen),) * 2))
    # Two draws without codes: what chance roughens in one recording is no change.
    nothing = replace(seen * 0.0, codes=np.zeros((2, 1)))
    changed = {
        "mean": {"means": seen.means},
        "onset": {"onset": np.ones_like(seen.onset)},
        "rare": {"rare": np.ones_like(seen.rare)},
        "steps": {"pixel_misfit": np.where(np.arange(128) < 3, 20.0, 0.1)},
        "codes": {"codes": np.tile(seen.codes, (2, 1))},
    }
    for kind, parts in changed.items():
        one = evidence.whitening.energies(evidence.point(replace(nothing, **parts)))
        assert one.pop(kind) > 0.0
        assert not any(one.values()), kind


def bars(n_columns: int) -> Columns:
    return np.where(np.arange(n_columns) // (n_columns // 5) % 2, 0.5, 2.5)


def test_a_scene_of_known_light_is_as_the_baseline_expects_it() -> None:
    """Its means, and variances that change at each edge, have z of mean 0 and deviation 1."""
    scene = Block(block="bars", kind="scene", exposure_us=500.0, level=0.0, lines=60, scene="bars")
    means, variances = [], []
    for rng in default_rng().spawn(6):
        blocks, light = [*plan(rng, 60), scene], {"bars": bars(128)}
        evidence = recorded(plain_model(128), blocks, rng, scenes=light)
        assert evidence.baseline.usable[-1].all()
        means.append(evidence.point(evidence.observed()).means[-1])
        std = evidence.pooled.std[-1, evidence.pooled.places["variance"]]
        observed = evidence.observed().pooled[-1, evidence.pooled.places["variance"]]
        variances.append(observed / std)
        # No edge is taken for a sample that stands out: one is beyond 7.5 in 10^13 by chance, and
        # beyond 5, as which the scatter of 60 lines may have it, in 10^6.
        assert evidence.sums[-1].rare[:2].sum() <= 1
    z = np.concatenate(means)
    # Some of a mean goes into its pixel's offset and slope: 18 blocks share two.
    assert 0.7 < z.std() < 1.0 + 5.0 / np.sqrt(2 * len(z))
    z = np.concatenate(variances)
    assert abs(z.mean()) < 5.0 / np.sqrt(len(z))
    assert z.std() < 1.0 + 5.0 / np.sqrt(2 * len(z))


def test_a_scene_whose_lines_differ_or_that_nobody_knows_is_left_out() -> None:
    header = RecordingHeader(
        camera=CameraHeader(columns=3, bit_depth=12),
        blocks=(
            Block(block="0", kind="flat", exposure_us=9.0, level=1.0),
            Block(block="1", kind="scene", exposure_us=9.0, level=0.0, scene="bars"),
            Block(block="2", kind="scene", exposure_us=9.0, level=0.0, scene="unknown"),
        ),
    )
    recording = SimpleNamespace(
        scenes={"bars": np.ones(3), "unknown": np.arange(6.0).reshape(2, 3)}
    )
    images = steady_images(recording)
    assert set(images) == {"bars"}
    known = [has_known_light(block, header, images) for block in header.blocks]
    assert known == [True, True, False]
