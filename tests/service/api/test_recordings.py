"""Recordings come in by upload, whatever else somebody packed."""

import io
import stat
import zipfile
from pathlib import Path
from typing import Any

import h5py
import pytest
from fastapi.testclient import TestClient

from calib.recording.commit_log import commit_path
from calib.recording.open import open_recording
from service.api.importing import import_archive
from service.app import create_app
from service.settings import Settings
from service.store.actor import Actor
from service.store.check.check import check
from service.store.recordings import Recordings
from service.store.store import Store
from tests.service.api.packing import as_files, as_folder, packed

ZIP = {"Content-Type": "application/zip"}


def upload(client: TestClient, body: bytes, **parameters: str) -> Any:
    return client.post("/v1/recordings", content=body, headers=ZIP, params=parameters)


def test_a_recording_comes_in_as_file_or_folder_and_is_the_same(
    client: TestClient, recording_file: Path, tmp_path: Path, settings: Settings
) -> None:
    digest = open_recording(recording_file).digest()
    first = upload(client, as_files(recording_file), name="sweep 3")
    second = upload(client, as_folder(recording_file, tmp_path, inside="sweep3/"))
    assert (first.status_code, second.status_code) == (201, 200)
    assert first.json() == second.json()
    assert first.json()["digest"] == digest
    assert first.json()["name"] == "sweep 3"
    assert first.headers["Location"] == f"/v1/recordings/{digest}"
    assert len(client.get("/v1/recordings").json()["items"]) == 1
    assert client.get(first.headers["Location"]).json() == first.json()
    kept = settings.recordings_folder / digest / "recording.h5"
    assert open_recording(kept).digest() == digest
    assert list(settings.work_folder.iterdir()) == []


def test_what_a_killed_service_had_under_way_goes_at_the_next_start(settings: Settings) -> None:
    (settings.work_folder / "import-1" / "unpacked").mkdir(parents=True)
    (settings.work_folder / "import-1" / "unpacked" / "rec.h5").write_bytes(b"half")
    (settings.work_folder / "upload.zip").write_bytes(b"half")
    with TestClient(create_app(settings)):
        assert list(settings.work_folder.iterdir()) == []


class Killed(BaseException):
    """Nothing of the service is done after this."""


@pytest.mark.parametrize("put_on_record", [False, True])
def test_an_upload_that_a_kill_cut_off_leaves_nothing_or_is_there(
    settings: Settings,
    recording_file: Path,
    monkeypatch: pytest.MonkeyPatch,
    put_on_record: bool,
) -> None:
    register = Recordings.register

    def killed(*given: Any, **named: Any) -> None:
        if put_on_record:
            register(*given, **named)
        raise Killed

    archive = settings.home / "upload.zip"
    with TestClient(create_app(settings)), Store.open(settings) as store:
        archive.write_bytes(as_files(recording_file))
        monkeypatch.setattr(Recordings, "register", killed)
        with pytest.raises(Killed):
            import_archive(archive, name="", by=Actor("ada"), settings=settings, store=store)
        monkeypatch.undo()
    digest = open_recording(recording_file).digest()
    assert (settings.recordings_folder / digest).is_dir()
    with TestClient(create_app(settings)), Store.open(settings) as store:
        assert store.recordings.knows(digest) == put_on_record
    assert (settings.recordings_folder / digest).is_dir() == put_on_record
    checked = check(settings, lambda *_: None)
    assert checked.findings == ()
    assert checked.recordings == put_on_record


def test_what_is_wrong_is_told_without_where_it_lies_on_the_server(
    client: TestClient, settings: Settings
) -> None:
    refused = upload(
        client, packed({"rec/recording.toml": b"[camera]\ncolumns = 4\nbit_depth = 8"})
    )
    assert refused.status_code == 422
    assert "conditions.csv" in refused.json()["detail"]
    assert str(settings.work_folder.parent) not in refused.text


def test_recordings_are_filtered(client: TestClient, recording_file: Path) -> None:
    upload(client, as_files(recording_file))
    assert len(client.get("/v1/recordings", params={"serial": "D0001"}).json()["items"]) == 1
    assert client.get("/v1/recordings", params={"serial": "D0002"}).json()["items"] == []
    assert client.get("/v1/recordings", params={"band": "red"}).json()["items"] == []


def link_in_zip() -> bytes:
    body = io.BytesIO()
    with zipfile.ZipFile(body, "w") as archive:
        member = zipfile.ZipInfo("recording.toml")
        member.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(member, "/etc/passwd")
    return body.getvalue()


BAD = {
    "no zip": (b"this is no archive", "not-a-zip", 422),
    "cut short": (packed({"recording.toml": b"x" * 9999})[:-30], "not-a-zip", 422),
    "leads up": (packed({"../../evil.toml": b""}), "unsafe-archive", 422),
    "absolute": (packed({"/evil.toml": b""}), "unsafe-archive", 422),
    "link": (link_in_zip(), "unsafe-archive", 422),
    "bomb": (packed({"frames/000.raw": bytes(20 << 20)}), "too-large", 413),
    "too large": (bytes(9 << 20), "too-large", 413),
    "nothing": (b"", "empty-body", 422),
    "no recording": (packed({"readme.txt": b"hello"}), "not-a-recording", 422),
    "not HDF5": (packed({"a.h5": b"nope", "a.frames.jsonl": b""}), "not-a-recording", 422),
    "bad toml": (packed({"recording.toml": b"camera = 3"}), None, 422),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_recording_is_refused_and_leaves_nothing(
    client: TestClient, settings: Settings, tmp_path: Path, case: str
) -> None:
    body, code, status = BAD[case]
    answer = upload(client, body)
    assert answer.status_code == status
    assert answer.headers["Content-Type"] == "application/problem+json"
    assert code in {None, answer.json()["code"]}
    assert list(settings.work_folder.iterdir()) == []
    assert not settings.recordings_folder.exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home"]
    assert client.get("/v1/recordings").json()["items"] == []


def test_a_file_that_reaches_for_others_is_refused(
    client: TestClient, recording_file: Path, tmp_path: Path
) -> None:
    copy = tmp_path / "rec.h5"
    copy.write_bytes(recording_file.read_bytes())
    with h5py.File(copy, "a") as file:
        file["elsewhere"] = h5py.ExternalLink("/etc/passwd", "/")
    commits = commit_path(recording_file).read_bytes()
    body = packed({"rec.h5": copy.read_bytes(), "rec.frames.jsonl": commits})
    assert upload(client, body).json()["code"] == "unsafe-file"


def test_a_file_without_its_commit_record_is_refused(
    client: TestClient, recording_file: Path
) -> None:
    answer = upload(client, packed({"rec.h5": recording_file.read_bytes()}))
    assert answer.json()["code"] == "no-commit-record"


def test_a_browser_that_was_tricked_cannot_upload(client: TestClient, recording_file: Path) -> None:
    for kind in ("text/plain", "multipart/form-data", "application/x-www-form-urlencoded", ""):
        answer = client.post(
            "/v1/recordings", content=as_files(recording_file), headers={"Content-Type": kind}
        )
        assert (answer.status_code, answer.json()["code"]) == (415, "wrong-media-type")
