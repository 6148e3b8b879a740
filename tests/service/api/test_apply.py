"""Raw lines go in, radiance comes out: the same as from the command."""

import io
import json
import tracemalloc
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from calib.radiometric.correction.apply import Correction
from service.settings import Settings
from service.store.store import Store
from tests.service.store.a_store import a_set, certified, day, verified

NPY = {"Content-Type": "application/x-npy"}
TAKEN: dict[str, Any] = {
    "exposure_us": 200, "at": "2026-06-01T00:00:00Z", "serial": "B0001", "band": "NIR",
    "gain": 0, "black_level": 0, "bit_depth": 12, "first_column": 0,
}  # fmt: skip


def npy(array: np.ndarray[Any, Any]) -> bytes:
    body = io.BytesIO()
    np.save(body, array)
    return body.getvalue()


def codes(n_lines: int = 5, seed: int = 1) -> np.ndarray[Any, np.dtype[np.uint16]]:
    return np.random.default_rng(seed).integers(0, 4096, (n_lines, 32), dtype=np.uint16)


@pytest.fixture
def set_id(store: Store) -> str:
    return certified(store, a_set(), day(1), day(12)).id


def apply(client: TestClient, set_id: str, body: bytes, **changes: Any) -> Any:
    taken = {key: value for key, value in {**TAKEN, **changes}.items() if value is not None}
    place = f"/v1/coefficient-sets/{set_id}/apply"
    return client.post(place, params=taken, content=body, headers=NPY)


@pytest.mark.parametrize("dtype", ["<u2", ">u2"])
def test_radiance_std_and_flags_are_those_of_the_correction(
    client: TestClient, set_id: str, dtype: str
) -> None:
    dn = codes(3000)
    answer = apply(client, set_id, npy(dn.astype(dtype)))
    assert answer.status_code == 200
    expected = Correction(a_set(), 200.0, camera=a_set().camera).lines(dn)
    with np.load(io.BytesIO(answer.content)) as found:
        np.testing.assert_array_equal(found["radiance"], expected.radiance)
        np.testing.assert_array_equal(found["std"], expected.std)
        np.testing.assert_array_equal(found["flags"], expected.flags)
        notes = json.loads(found["notes.json"])
    assert notes["coefficient_set"] == set_id
    assert notes["radiance_unit"] == "W m-2 sr-1"
    assert notes["notes"] == []


def test_what_is_not_stated_is_noted(client: TestClient, set_id: str) -> None:
    answer = apply(client, set_id, npy(codes()), band=None, gain=None)
    with np.load(io.BytesIO(answer.content)) as found:
        notes = json.loads(found["notes.json"])["notes"]
    assert len(notes) == 1
    assert "band, gain" in notes[0]


REFUSED: dict[str, tuple[dict[str, Any], int, str]] = {
    "another camera": ({"serial": "B0002"}, 422, "set-mismatch"),
    "another band": ({"band": "red"}, 422, "set-mismatch"),
    "another gain": ({"gain": 6}, 422, "set-mismatch"),
    "another depth": ({"bit_depth": 10}, 422, "set-mismatch"),
    "too late": ({"at": "2027-06-01T00:00:00Z"}, 422, "outside-validity"),
    "unknown time": ({"at": None}, 422, "outside-validity"),
    "no exposure": ({"exposure_us": None}, 422, "invalid-request"),
    "bad exposure": ({"exposure_us": "nan"}, 422, "invalid-request"),
    "a typo": ({"seriall": "B0001"}, 422, "invalid-request"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_set_that_does_not_match_is_refused(client: TestClient, set_id: str, case: str) -> None:
    changes, status, code = REFUSED[case]
    answer = apply(client, set_id, npy(codes()), **changes)
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_force_applies_it_all_the_same_and_flags_every_pixel(
    client: TestClient, set_id: str
) -> None:
    answer = apply(client, set_id, npy(codes()), serial="B0002", force=True)
    with np.load(io.BytesIO(answer.content)) as found:
        assert (found["flags"] & 32 == 32).all()
        assert "serial" in json.loads(found["notes.json"])["notes"][0]


def test_a_set_that_is_not_certified_needs_force(client: TestClient, store: Store) -> None:
    draft = verified(store, a_set()).id
    answer = apply(client, draft, npy(codes()))
    assert (answer.status_code, answer.json()["code"]) == (409, "not-certified")
    assert apply(client, draft, npy(codes()), force=True).status_code == 200


BODIES: dict[str, tuple[bytes, int, str]] = {
    "nothing": (b"", 422, "empty-body"),
    "no array": (b"GIF89a" * 99, 422, "not-npy"),
    "header alone": (npy(codes())[:60], 422, "not-npy"),
    "cut short": (npy(codes())[:-7], 422, "frames-truncated"),
    "too long": (npy(codes()) + b"more", 422, "frames-truncated"),
    "real numbers": (npy(np.zeros((4, 32))), 422, "wrong-dtype"),
    "one line without an axis": (npy(np.zeros(32, np.uint16)), 422, "wrong-shape"),
    "columns first": (npy(np.asfortranarray(codes())), 422, "wrong-shape"),
    "no lines": (npy(codes(0)), 422, "wrong-shape"),
    "too many columns": (npy(np.zeros((4, 33), np.uint16)), 422, "wrong-columns"),
    "too large": (bytes(2 << 20), 413, "too-large"),
}


@pytest.mark.parametrize("case", BODIES)
def test_a_body_that_is_no_lines_is_refused(
    client: TestClient, set_id: str, settings: Settings, case: str
) -> None:
    body, status, code = BODIES[case]
    answer = apply(client, set_id, body)
    assert (answer.status_code, answer.json()["code"]) == (status, code)
    assert list(settings.work_folder.iterdir()) == []


def test_pickled_objects_are_never_loaded(client: TestClient, set_id: str) -> None:
    body = io.BytesIO()
    np.save(body, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    assert apply(client, set_id, body.getvalue()).json()["code"] == "wrong-dtype"


def test_the_answer_is_never_in_memory_as_a_whole() -> None:
    """The generator alone: what it holds does not grow with the number of lines."""
    import tempfile

    from service.api.radiance_stream import radiance_npz
    from service.api.raw_lines import uploaded_lines

    correction = Correction(a_set(), 200.0, camera=a_set().camera)
    body = npy(np.zeros((400_000, 32), np.uint16))
    with tempfile.TemporaryFile() as spool:
        spool.write(body)
        lines = uploaded_lines(spool, len(body), n_columns=32)
        first = radiance_npz(correction, lines, ())
        n_bytes = len(next(first))
        tracemalloc.start()
        n_bytes += sum(len(part) for part in first)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert n_bytes > 9 * 32 * 400_000
    assert peak < n_bytes / 4
