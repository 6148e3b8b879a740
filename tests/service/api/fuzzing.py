"""Requests that the OpenAPI document allows, and such as it does not, sent to an app."""

from typing import Any

import numpy as np
import requests
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from schemathesis import Case, GenerationMode, openapi, serializer
from schemathesis.schemas import APIOperation
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.service.api.packing import packed
from tests.service.api.test_apply import npy

ZIPS = st.one_of(
    st.binary(max_size=256),
    st.dictionaries(
        st.sampled_from(["recording.toml", "conditions.csv", "mtf.toml", "frames/000.npy", "a.h5"]),
        st.binary(max_size=64),
        max_size=3,
    ).map(packed),
)
NPYS = st.one_of(
    st.binary(max_size=256),
    st.sampled_from([(1, 32), (4, 32), (4, 31), (32,), (0, 32)]).map(
        lambda shape: npy(np.zeros(shape, np.uint16))
    ),
)
for _kind, _bodies in (("application/zip", ZIPS), ("application/x-npy", NPYS)):
    openapi.media_type(_kind, _bodies)
    serializer.alias(_kind, "application/octet-stream")


CHECKS = [
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]
KNOWN_SHARE = 2
"""Of so many cases with parameters in their path, one names what is there."""


def operations(document: dict[str, Any]) -> list[APIOperation[Any, Any, Any, Any]]:
    """Return all operations of a document."""
    return [found.ok() for found in openapi.from_dict(document).get_all_operations()]


def fuzz(
    client: TestClient,
    operation: APIOperation[Any, Any, Any, Any],
    known: dict[str, str],
    *,
    examples: int,
    without_bench: bool,
) -> int:
    """Send requests to one operation and check each answer; return how many were sent.

    Args:
        client: Of a started app.
        operation: Of its document.
        known: Path parameters of things that are there.
        examples: How many requests.
        without_bench: Whether the app has none: it may say so, and no other 5xx.
    """
    sent = 0
    cases = st.one_of(
        operation.as_strategy(generation_mode=GenerationMode.POSITIVE),
        operation.as_strategy(generation_mode=GenerationMode.NEGATIVE),
    )

    @settings(
        max_examples=examples, deadline=None, database=None, derandomize=False,
        suppress_health_check=list(HealthCheck), phases=[Phase.generate, Phase.shrink],
    )  # fmt: skip
    @given(case=cases, at=st.integers(0, KNOWN_SHARE - 1))
    def one(case: Case, at: int) -> None:
        nonlocal sent
        sent += 1
        if at == 0:
            case.path_parameters.update({k: known[k] for k in case.path_parameters if k in known})
        answer = send(client, case)
        refused = without_bench and answer.status_code == 503 and "no-bench" in answer.text
        assert answer.status_code < 500 or refused, (case.as_curl_command(), answer.text)
        case.validate_response(answer, checks=CHECKS)

    one()
    return sent


def send(client: TestClient, case: Case) -> Any:
    """Send a case as it would go over the wire."""
    wanted = case.as_transport_kwargs(base_url="http://127.0.0.1")
    made = requests.Request(**wanted).prepare()
    # Keys are the business of the table of scopes; each wrong one would be waited for.
    headers = {
        k: v for k, v in made.headers.items() if k.lower() not in {"cookie", "authorization"}
    }
    return client.request(made.method or "GET", made.url or "", content=made.body, headers=headers)
