"""The audit log proven by who reads it, without the service's own word for it."""

import json
from collections.abc import Sequence
from datetime import UTC
from hashlib import sha256

from service.api.answers.audit import AuditAnswer


def proven(entries: Sequence[AuditAnswer]) -> list[str]:
    """Return the digests that entries must have, from what was read of them alone."""
    digests = ["0" * 64]
    for number, entry in enumerate(entries, start=1):
        content = [
            number, entry.at.astimezone(UTC).isoformat(timespec="microseconds"), entry.who,
            entry.key_id, entry.action, entry.subject, entry.before, entry.after,
        ]  # fmt: skip
        text = digests[-1] + json.dumps(content, sort_keys=True, ensure_ascii=False)
        digests.append(sha256(text.encode()).hexdigest())
    return digests[1:]
