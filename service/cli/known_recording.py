"""Making a recording known to the store; its frames stay where they are."""

from pathlib import Path
from typing import TYPE_CHECKING

from service.store.actor import Actor
from service.store.errors import NotInStoreError

if TYPE_CHECKING:
    from calib.recording.protocol import Recording
    from service.store.records import RecordingRecord
    from service.store.store import Store


def make_known(
    store: "Store", recording: "Recording", *, by: str, digest: str | None = None
) -> "RecordingRecord":
    """Register `recording`; one that the store still finds elsewhere stays there.

    Args:
        store: The store.
        recording: The recording.
        by: Who.
        digest: Its digest where it is known already; computing it reads all frames.
    """
    digest = digest or recording.digest()
    try:
        known = store.recordings.get(digest)
    except NotInStoreError:
        known = None
    if known is not None and Path(known.path).exists():
        return known
    return store.recordings.register(
        recording, name=recording.path.name, by=Actor(by), digest=digest
    )
