from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.errors import InputError, NotDeterminedError
from calib.recording.gathered import gathered
from calib.recording.header import CameraHeader, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.statistics import CancelledError, column_statistics
from calib.recording.tone import Tone
from calib.recording.tone_removal import tone_amplitude
from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import HEADER, blocks, codes, record, write_recording

N_LINES, N_COLUMNS = 400, 60


def test_statistics_are_those_of_numpy(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    statistics = column_statistics(recording)
    assert [each.block for each in statistics.fit] == list(blocks())
    assert statistics.held_out == ()
    for each in statistics.fit:
        dn = codes(each.block.block, 20)
        assert each.n_lines == 20
        assert np.allclose(each.mean_dn, dn.mean(axis=0), rtol=1e-14)
        assert np.allclose(each.variance_dn2, dn.var(axis=0, ddof=1), rtol=1e-12)
        assert np.array_equal(each.n_at_zero, (dn == 0).sum(axis=0))
        assert np.array_equal(each.n_at_full_scale, (dn == 4095).sum(axis=0))


@pytest.mark.parametrize("every", [2, 3, 7, 20])
def test_each_line_is_either_fitted_or_held_out(tmp_path: Path, every: int) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))  # in frames of 8, 8, 4
    statistics = column_statistics(recording, held_out_every=every)
    for fit, held in zip(statistics.fit, statistics.held_out, strict=True):
        dn = codes(fit.block.block, 20)
        kept = np.arange(20) % every != every - 1
        assert (fit.n_lines, held.n_lines) == (kept.sum(), (~kept).sum())
        assert np.allclose(fit.mean_dn, dn[kept].mean(axis=0), rtol=1e-14)
        assert np.allclose(held.mean_dn, dn[~kept].mean(axis=0), rtol=1e-14)
        assert np.allclose(fit.variance_dn2, dn[kept].var(axis=0, ddof=1), rtol=1e-12)


def test_a_block_shorter_than_the_distance_has_nothing_held_out(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    assert column_statistics(recording, held_out_every=21).held_out == ()


@pytest.mark.parametrize("every", [-1, 1])
def test_holding_out_everything_is_refused(tmp_path: Path, every: int) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    with pytest.raises(InputError, match="leaves nothing to fit"):
        column_statistics(recording, held_out_every=every)


def test_an_area_sensors_pixels_are_flattened(tmp_path: Path) -> None:
    header = RecordingHeader(camera=CameraHeader(columns=6, rows=4, bit_depth=8))
    path = write_recording(tmp_path / "a.h5", header)
    fit = column_statistics(open_recording(path)).fit[1]
    dn = codes("001", 20, header.camera).reshape(20, 24)
    assert np.allclose(fit.mean_dn, dn.mean(axis=0), rtol=1e-14)


@pytest.mark.parametrize("every", [0, 7])
def test_area_frames_that_come_one_by_one_give_what_they_give_together(
    tmp_path: Path, every: int
) -> None:
    camera = CameraHeader(columns=6, rows=4, bit_depth=12)
    dn = np.random.default_rng(1).integers(0, 4096, (100, 4, 6), dtype=np.uint16)
    found = []
    for frame_lines in (1, 100):
        path = tmp_path / f"{frame_lines}.h5"
        with RecordingWriter.create(path, RecordingHeader(camera=camera), frame_lines) as writer:
            record(writer, blocks()[0].model_copy(update={"lines": 100}), dn, frame_lines)
        found.append(column_statistics(open_recording(path), held_out_every=every))
    one_by_one, together = found
    assert one_by_one.fit[0].n_lines == (100 if every == 0 else 86)
    for name in ("fit", "held_out"):
        for a, b in zip(getattr(one_by_one, name), getattr(together, name), strict=True):
            assert (a.n_lines, a.block) == (b.n_lines, b.block)
            for of in ("mean_dn", "variance_dn2", "n_at_zero", "n_at_full_scale"):
                assert np.array_equal(getattr(a, of), getattr(b, of))


def test_frames_are_gathered_in_order_and_not_without_end() -> None:
    ten_mb = np.zeros((1, 1000, 5000), np.uint16)
    small = [np.full((2, 2, 2), k, np.uint8) for k in range(40)]
    assert [len(stack) for stack in gathered([ten_mb] * 13)] == [6, 6, 1]
    stacks = list(gathered(small))
    assert [len(stack) for stack in stacks] == [32, 32, 16]
    assert np.array_equal(np.concatenate(stacks), np.concatenate(small))
    assert list(gathered([])) == []


def test_progress_rises_to_one_and_cancelling_stops(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    seen: list[float] = []
    column_statistics(recording, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    with pytest.raises(CancelledError, match="block 000"):
        column_statistics(recording, cancelled=lambda: True)


def phase(tone: Tone, n_lines: int, n_columns: int) -> NDArray[np.float64]:
    clocks = np.arange(n_lines)[:, None] * tone.pixels_per_line + np.arange(n_columns)
    return np.asarray(2 * np.pi * tone.cycles_per_pixel * clocks, dtype=np.float64)


def lines_with(tone: Tone, amplitude_dn: float, phase_rad: float, seed: int) -> NDArray[np.uint16]:
    rng = np.random.default_rng(seed)
    pattern = 1000 + 80 * rng.normal(size=N_COLUMNS)
    wave = amplitude_dn * np.cos(phase(tone, N_LINES, N_COLUMNS) + phase_rad)
    noise = 3 * rng.normal(size=(N_LINES, N_COLUMNS))
    return np.round(pattern + wave + noise).astype(np.uint16)


TONES = {
    "several cycles a line": Tone.per_line(3.37, 70),
    "less than one cycle a line": Tone.per_line(0.013, 64),
    "negative frequency": Tone.per_line(-7.2, 80),
    "half a cycle between lines": Tone.per_line(2.5, 61),
    "close to Nyquist": Tone(0.4971, 67.0),
}


@pytest.mark.parametrize("tone", TONES.values(), ids=TONES)
@pytest.mark.parametrize("seed", [1, 2])
def test_the_tone_is_the_least_squares_one(tone: Tone, seed: int) -> None:
    dn = lines_with(tone, 6.0, 0.7 * seed, seed)
    at = phase(tone, N_LINES, N_COLUMNS)
    waves = np.stack([np.cos(at), -np.sin(at)], axis=-1)
    waves -= waves.mean(axis=0)
    wanted, *_ = np.linalg.lstsq(waves.reshape(-1, 2), (dn - dn.mean(axis=0)).ravel())
    found = tone_amplitude(dn, tone)
    assert np.allclose([found.real, found.imag], wanted, rtol=1e-9)
    # and it is the one put in: each component's standard error is at most 3·sqrt(2/samples)·2
    error = abs(found - 6.0 * np.exp(0.7j * seed))
    assert error < 4 * 3 * np.sqrt(8 / dn.size) * 2


@pytest.mark.parametrize("tone", TONES.values(), ids=TONES)
def test_removing_a_tone_from_sums_is_removing_it_from_samples(tmp_path: Path, tone: Tone) -> None:
    camera = CameraHeader(columns=N_COLUMNS, bit_depth=12)
    block = blocks(2, lines=N_LINES)[1]
    dn = lines_with(tone, 9.0, 1.1, seed=4)
    with RecordingWriter.create(tmp_path / "a.h5", RecordingHeader(camera=camera), 160) as writer:
        record(writer, block, dn, frame_lines=160)
    clean = []
    for first in (0, 160, 320):
        frame = dn[first : first + 160]
        wave = tone_amplitude(frame, tone) * np.exp(1j * phase(tone, len(frame), N_COLUMNS))
        clean.append(frame - wave.real)
    samples = np.concatenate(clean)
    held = np.arange(N_LINES) % 7 == 6
    statistics = column_statistics(open_recording(tmp_path / "a.h5"), tone=tone, held_out_every=7)
    for part, lines in (
        (statistics.fit[0], samples[~held]),
        (statistics.held_out[0], samples[held]),
    ):
        assert np.allclose(part.mean_dn, lines.mean(axis=0), rtol=0, atol=1e-9)
        assert np.allclose(part.variance_dn2, lines.var(axis=0, ddof=1), rtol=0, atol=1e-8)


def test_with_the_tone_removed_only_the_noise_is_left() -> None:
    tone = TONES["several cycles a line"]
    dn = lines_with(tone, 9.0, 0.2, seed=8)
    wave = tone_amplitude(dn, tone) * np.exp(1j * phase(tone, N_LINES, N_COLUMNS))
    variance = (dn - wave.real).var(axis=0, ddof=1).mean()
    expected = 3.0**2 + 1 / 12  # rounding
    assert abs(variance - expected) < 4 * expected * np.sqrt(2 / dn.size)


@pytest.mark.parametrize("cycles_per_line", [3.0, 0.0001])
def test_whole_cycles_a_line_are_a_part_of_the_offset(cycles_per_line: float) -> None:
    tone = Tone.per_line(cycles_per_line, 70)
    with pytest.raises(NotDeterminedError) as refused:
        tone_amplitude(codes("000", 100, HEADER.camera), tone)
    assert refused.value.code == "tone-not-determined"


def test_a_tone_is_not_removed_from_area_frames(tmp_path: Path) -> None:
    header = RecordingHeader(camera=CameraHeader(columns=6, rows=4, bit_depth=8))
    recording = open_recording(write_recording(tmp_path / "a.h5", header))
    with pytest.raises(InputError, match="area sensor"):
        column_statistics(recording, tone=Tone(0.1, 6.5))


@pytest.mark.parametrize("cycles", [0.0, 0.6, float("nan")])
def test_an_impossible_tone_is_refused(cycles: float) -> None:
    with pytest.raises(InputError, match="cannot be"):
        Tone(cycles, 100.0)
