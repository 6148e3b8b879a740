"""What the client downloads is there whole, or not at all."""

from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from calib.errors import DarkflatError
from service.client import Client, ServiceLostError
from service.store.actor import Actor
from service.store.store import Store
from tests.service.client.answering import answered_by
from tests.service.store.a_store import a_set


def broken_after(*pieces: bytes) -> httpx2.Response:
    def body() -> Iterator[bytes]:
        yield from pieces
        raise httpx2.ReadError("reset by peer")

    return httpx2.Response(200, content=body())


def test_a_download_that_breaks_is_begun_anew(tmp_path: Path) -> None:
    answers = [
        broken_after(b"a long beginning"),
        broken_after(),
        httpx2.Response(200, content=b"whole"),
    ]
    client = answered_by(lambda _: answers.pop(0))
    out = client.recordings.download("d", tmp_path / "recording.zip")
    assert out.read_bytes() == b"whole"
    assert [path.name for path in tmp_path.iterdir()] == ["recording.zip"]


def test_a_download_that_never_ends_well_leaves_what_was_there(tmp_path: Path) -> None:
    out = tmp_path / "set.h5"
    out.write_bytes(b"an older one")
    client = answered_by(lambda _: broken_after(b"half"))
    client._link.patience_s = 0.0
    with pytest.raises(ServiceLostError):
        client.coefficient_sets.download("s", out)
    assert out.read_bytes() == b"an older one"
    assert [path.name for path in tmp_path.iterdir()] == ["set.h5"]


def test_an_output_that_cannot_be_written_is_one_sentence(
    client: Client, store: Store, tmp_path: Path
) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    with pytest.raises(DarkflatError) as refused:
        client.coefficient_sets.download(set_id, tmp_path / "nowhere" / "set.h5")
    assert refused.value.code == "cannot-write"


def test_a_set_comes_as_it_is_kept(client: Client, store: Store, tmp_path: Path) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    out = client.coefficient_sets.download(set_id, tmp_path / "set.h5")
    assert out.read_bytes() == store.sets.files.path(set_id).read_bytes()
