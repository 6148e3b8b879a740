"""What clients do while a server dies, and what it acknowledged before: uploads, certifications."""

import io
import threading
import time
import uuid
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from calib.errors import DarkflatError
from service.client import Client
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store
from tests.service.served import Served
from tests.service.store.a_store import a_set, day


@dataclass
class Acknowledged:
    """What the service said that it has.

    Attributes:
        recordings: Digests, as answered to uploads.
        verified: Coefficient sets.
        certified: Likewise.
        certifying_s: How long the last of them took.
    """

    recordings: list[str] = field(default_factory=list)
    verified: list[str] = field(default_factory=list)
    certified: list[str] = field(default_factory=list)
    certifying_s: float = 0.05


class ClientsAtWork:
    """Two clients, each in a thread, that upload and certify until nobody answers any more.

    Attributes:
        certifying: Set whenever a certification is asked for.
        asked_at_s: When what a client wants last was asked for, by its name.
    """

    def __init__(self, service: Served, archive: bytes, folder: Path, told: Acknowledged) -> None:
        """`archive` is a packed recording folder; each upload is one of another camera."""
        self._service = service
        self._archive = archive
        self._upload_file = folder / "upload.zip"
        self._told = told
        self.certifying = threading.Event()
        self.asked_at_s: dict[str, float] = {}
        self._threads = [
            threading.Thread(target=self._until_it_dies, args=(work,), daemon=True)
            for work in (self._upload, self._certify)
        ]

    def __enter__(self) -> Self:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        for thread in self._threads:
            thread.join(120)
            assert not thread.is_alive()

    def _until_it_dies(self, work: Callable[[Client], None]) -> None:
        with self._service.client(patience_s=0.0) as client:
            while True:
                try:
                    work(client)
                except DarkflatError as error:
                    assert error.code == "service-lost", error  # noqa: PT017
                    return

    def _upload(self, client: Client) -> None:
        serial = f"U{len(self._told.recordings)}"
        self._upload_file.write_bytes(_of_camera(self._archive, serial))
        self._asks("upload")
        self._told.recordings.append(client.recordings.upload(self._upload_file).digest)
        self._has("upload")

    def _certify(self, client: Client) -> None:
        serial = f"C{uuid.uuid4().hex}"  # what was not acknowledged may be there all the same
        with Store.open(Settings(home=self._service.home)) as store:
            set_id = store.sets.add(a_set(serial=serial), by=Actor("ada")).id
        self._told.verified.append(client.coefficient_sets.verify(set_id).id)
        self._asks("certification")
        self.certifying.set()
        made = client.coefficient_sets.certify(set_id, valid_from=day(1), reason="due")
        self._told.certified.append(made.id)
        self._told.certifying_s = self._has("certification")

    def _asks(self, what: str) -> None:
        self.asked_at_s[what] = time.monotonic()

    def _has(self, what: str) -> float:
        """It was acknowledged; return how long that took."""
        return time.monotonic() - self.asked_at_s.pop(what)


def _of_camera(archive: bytes, serial: str) -> bytes:
    """Return the same recording, of a camera with another serial number."""
    body = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(archive)) as given,
        zipfile.ZipFile(body, "w", zipfile.ZIP_STORED) as made,
    ):
        for name in given.namelist():
            content = given.read(name)
            if name.endswith("recording.toml"):
                lines = content.decode().splitlines()
                kept = [each for each in lines if not each.startswith("serial")]
                at = kept.index("[camera]") + 1
                content = "\n".join([*kept[:at], f'serial = "{serial}"', *kept[at:]]).encode()
            made.writestr(name, content)
    return body.getvalue()
