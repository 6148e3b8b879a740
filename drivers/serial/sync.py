"""How to get back into step with a device that may still answer an old question."""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Sync:
    """A question whose answer is known, to get back into step.

    Attributes:
        question: Bytes to send, terminator included.
        answer: What the reply looks like; nothing else that the device says matches.
        clear: Ends a half-sent command, before the line is listened to until it is quiet.
        preamble: Sent before the question (addressing); after `preamble_answer` has come,
            `preamble_s` pass before the question.
    """

    question: bytes
    answer: re.Pattern[bytes]
    clear: bytes = b""
    preamble: bytes = b""
    preamble_answer: re.Pattern[bytes] | None = None
    preamble_s: float = 0.0


def whole_line(text: str) -> re.Pattern[bytes]:
    """Return the pattern of a reply that is exactly `text`, whatever mix of CR and LF ends it."""
    return re.compile(rb"(?<![^\r\n])" + re.escape(text.encode("ascii")) + rb"(?=[\r\n])")
