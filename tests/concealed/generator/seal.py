"""Answers that are fixed before the run and can be read only after it.

An answer's commitment is the SHA-256 over a random key and its canonical bytes: printed before the
run, it binds the answer and, without the key, tells nothing of it. The answer itself is kept under
a keystream of SHAKE-256; opening checks the commitment.
"""

import hashlib
import io
import json
from typing import Any

import numpy as np

from tests.concealed.generator.answer import Answer

KEY_BYTES = 32


def canonical(content: Any) -> bytes:
    """Return JSON that is the same for the same content: keys sorted, no spaces."""
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def commitment(key: bytes, content: bytes) -> str:
    """Return the SHA-256 that binds `content`, in hexadecimal."""
    return hashlib.sha256(key + content).hexdigest()


def sealed(answer: Answer, key: bytes) -> tuple[bytes, str]:
    """Return the answer as nobody without `key` can read it, and its commitment."""
    content = _packed(answer)
    digest = commitment(key, content)
    return bytes.fromhex(digest) + _stream(content, key, digest), digest


def opened(content: bytes, key: bytes) -> Answer:
    """Return the answer; ValueError where the key is another or a byte was changed."""
    digest, body = content[:32].hex(), content[32:]
    packed = _stream(body, key, digest)
    if commitment(key, packed) != digest:
        raise ValueError("the seal does not fit: another key, or the answer was changed")
    with np.load(io.BytesIO(packed)) as arrays:
        every = {name: arrays[name] for name in arrays.files}
    told = json.loads(every.pop("told").tobytes())
    return Answer(told, every)


def _packed(answer: Answer) -> bytes:
    """Return JSON and arrays as one .npz, whose bytes hang on nothing but the content."""
    out = io.BytesIO()
    told = np.frombuffer(canonical(answer.told), dtype=np.uint8)
    np.savez(out, told=told, **dict(sorted(answer.arrays.items())))  # type: ignore[arg-type]
    return out.getvalue()


def _stream(content: bytes, key: bytes, nonce: str) -> bytes:
    stream = hashlib.shake_256(key + nonce.encode()).digest(len(content))
    mixed = np.frombuffer(content, np.uint8) ^ np.frombuffer(stream, np.uint8)
    return mixed.tobytes()
