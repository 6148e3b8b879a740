"""What is answered, from whatever a recording is, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.arrays import RawLines
from calib.errors import NotDeterminedError
from calib.recording.block_statistics import BlockStatistics, RecordingStatistics
from calib.recording.folder_recording import FolderRecording
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.statistics import column_statistics
from calib.report.style import as_svg, house_style
from calib.transfer.photon_transfer.figures import covariances, transfer_curve
from calib.transfer.photon_transfer.measure import gain_and_noise, photon_transfer
from tests.calib.transfer.photon_transfer.simulated import GAIN, READ_DN, Held, recording


@pytest.fixture(scope="module")
def drawn() -> Held:
    return recording("straight", 60, 300, np.random.default_rng(7))


def without(held: Held, *kinds: str) -> Held:
    blocks = tuple(b for b in held.header.blocks if b.kind not in kinds)
    return replace(held, header=held.header.model_copy(update={"blocks": blocks}))


def test_the_answer_is_json_with_every_figure_and_its_error(drawn: Held) -> None:
    answer = json.loads(json.dumps(photon_transfer(drawn).answer(), allow_nan=False))
    assert answer["method"] == "ptc"
    for name in ("system_gain_dn_per_e", "read_noise_dn", "read_noise_e"):
        assert answer[name]["std"] > 0
        assert answer["taps"][0][name]["std"] > 0
    assert answer["model"] == "straight"
    assert {"straight", "nonlinear", "brighter_fatter"} <= answer["taps"][0]["models"].keys()
    assert set(answer["taps"][0]["brighter_fatter_series"]) == {
        "first_order", "full", "full_with_b",
    }  # fmt: skip
    assert answer["taps"][0]["why"]


def test_column_statistics_give_the_same_with_less_error(drawn: Held) -> None:
    by_pairs = photon_transfer(drawn)
    by_columns = gain_and_noise(column_statistics(drawn), drawn.header.camera)
    for found in (by_pairs, by_columns):
        assert abs(found.system_gain.value - GAIN) < 4 * found.system_gain.std
        assert abs(found.read_noise_dn.value - READ_DN) < 4 * found.read_noise_dn.std
    # Differences have 3/2 of the variance of what is taken about the mean.
    ratio = by_pairs.read_noise_dn.std / by_columns.read_noise_dn.std
    assert abs(ratio - np.sqrt(1.5)) < 0.15
    assert any("column statistics" in w for w in by_columns.warnings)


def test_sums_alone_give_gain_and_noise(tmp_path: Path, drawn: Held) -> None:
    rows, conditions = ["block,samples,mean_dn,variance_dn2"], [
        "block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"
    ]  # fmt: skip
    for s in column_statistics(drawn).fit:
        b = s.block
        conditions.append(f"{b.block},{b.kind},{b.exposure_us},{b.level},,,60,")
        rows.append(f"{b.block},{60 * 300},{s.mean_dn.mean()},{s.variance_dn2.mean()}")
    (tmp_path / "recording.toml").write_text("[camera]\ncolumns = 300\nbit_depth = 12\n")
    (tmp_path / "conditions.csv").write_text("\n".join(conditions))
    (tmp_path / "statistics.csv").write_text("\n".join(rows))
    found = photon_transfer(FolderRecording(tmp_path))
    assert abs(found.system_gain.value - GAIN) < 4 * found.system_gain.std
    assert abs(found.read_noise_e.value - READ_DN / GAIN) < 4 * found.read_noise_e.std


def test_taps_have_gains_of_their_own_and_one_that_is_their_mean() -> None:
    rng = np.random.default_rng(3)
    one = recording("straight", 100, 200, rng)
    frames = {}
    for name, (dn,) in one.stretches.items():
        wide = dn.astype(np.float64)
        wide[:, 1::2] = 100 + 1.1 * (wide[:, 1::2] - 100)
        frames[name] = (np.rint(wide).astype(np.uint16),)
    camera = CameraHeader(columns=200, bit_depth=12, taps=2, tap_layout="odd_even")
    header = one.header.model_copy(update={"camera": camera})
    found = photon_transfer(replace(one, header=header, stretches=frames))
    even, odd = (t.system_gain for t in found.taps)
    assert abs(even.value - GAIN) < 4 * even.std
    assert abs(odd.value - 1.1 * GAIN) < 4 * odd.std
    assert found.system_gain.value == pytest.approx((even.value + odd.value) / 2)
    assert found.system_gain.std < max(even.std, odd.std)


def test_without_darks_the_read_noise_is_unknown_and_says_why(drawn: Held) -> None:
    found = photon_transfer(without(drawn, "dark"))
    assert not found.read_noise_dn.is_known
    assert not found.read_noise_e.is_known
    assert "no darks" in found.read_noise_dn.reason
    assert abs(found.system_gain.value - GAIN) < 4 * found.system_gain.std


@pytest.mark.parametrize(
    ("kinds", "lines"), [(("flat",), 60), ((), 1)], ids=["darks alone", "single lines"]
)
def test_nothing_is_made_of_no_temporal_noise(
    drawn: Held, kinds: tuple[str, ...], lines: int
) -> None:
    short = {name: (dn[:lines],) for name, (dn,) in drawn.stretches.items()}
    with pytest.raises(NotDeterminedError) as refusal:
        photon_transfer(without(replace(drawn, stretches=short), *kinds))
    assert refusal.value.code == "no-temporal-noise"


def test_a_range_without_flats_is_refused(drawn: Held) -> None:
    with pytest.raises(NotDeterminedError) as refusal:
        photon_transfer(drawn, most_dn=50.0)
    assert refusal.value.code == "photon-transfer-range"


def test_columns_that_flicker_are_left_out_and_counted(drawn: Held) -> None:
    rng = np.random.default_rng(1)
    frames = {}
    for name, (dn,) in drawn.stretches.items():
        noisy = dn.astype(np.float64)
        noisy[:, 17] += 12 * rng.standard_normal(len(dn))
        noisy[:, 40] = 500
        frames[name] = (np.clip(np.rint(noisy), 0, 4095).astype(np.uint16),)
    found = photon_transfer(replace(drawn, stretches=frames))
    assert found.curve.defects == 2
    assert abs(found.read_noise_dn.value - READ_DN) < 4 * found.read_noise_dn.std


def test_clipped_blocks_take_no_part() -> None:
    bright = recording(
        "straight", 60, 300, np.random.default_rng(9), (0.1, 0.3, 0.5, 0.8, 1.2, 1.5)
    )
    found = photon_transfer(bright)
    used = found.taps[0].used
    assert used.highest_dn < 4095 - 4.5 * 30
    assert np.isfinite(used.turn_off_dn)
    assert abs(found.system_gain.value - GAIN) < 4 * found.system_gain.std


def test_statistics_of_single_lines_are_refused() -> None:
    block = Block(block="0", kind="flat", exposure_us=1.0, level=1.0, lines=1)
    nothing = np.zeros(4, np.int64)
    one = BlockStatistics(block, 1, np.full(4, 9.0), np.full(4, np.nan), nothing, nothing)
    with pytest.raises(NotDeterminedError, match="many lines"):
        gain_and_noise(RecordingStatistics((one,)), CameraHeader(columns=4, bit_depth=8))


def test_figures_are_drawn_of_whatever_there_is(drawn: Held) -> None:
    tap = photon_transfer(drawn).taps[0]
    with house_style():
        assert "Photon transfer" in transfer_curve(tap).axes[0].get_title(loc="left")
        assert as_svg(covariances([tap])).startswith("<svg")


def test_a_header_alone_is_no_recording() -> None:
    empty = Held(RecordingHeader(camera=CameraHeader(columns=4, bit_depth=8)), {})
    with pytest.raises(NotDeterminedError) as refusal:
        photon_transfer(empty)
    assert refusal.value.code == "no-temporal-noise"


@pytest.mark.parametrize("seed", range(3))
def test_white_lines_are_not_said_to_lag_and_lagging_ones_are(seed: int) -> None:
    white = recording("straight", 40, 2000, np.random.default_rng(seed))
    assert not any("next one's" in w for w in photon_transfer(white).warnings)

    def lagging(dn: RawLines) -> tuple[RawLines, ...]:
        mean, own = dn.mean(axis=0), dn - dn.mean(axis=0)
        own[1:] += 0.05 * own[:-1]
        return (np.clip(np.rint(mean + own), 0, 65535).astype(np.uint16),)

    frames = {name: lagging(np.concatenate(dn)) for name, dn in white.stretches.items()}
    warnings = photon_transfer(replace(white, stretches=frames)).warnings
    assert any("next one's by +0.0" in w for w in warnings)
