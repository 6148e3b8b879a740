"""Metrics as Prometheus reads them, a log whose lines say which run they are about, readiness."""

import io
import json
import logging
import logging.config
import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from prometheus_client.parser import text_string_to_metric_families

from service.app import create_app
from service.runs.frames import FrameCount
from service.sequencer.events import Progress
from service.settings import Settings
from service.store.run_records import FINAL
from service.watching.log import ENVIRONMENT, LogForm, Subject, log_config
from tests.service.api.test_runs import SHORT, start, until
from tests.service.api.test_service import parts_of
from tests.service.sequencer.benches import in_process


@pytest.fixture
def errors(tmp_path: Path) -> Iterator[Path]:
    """Where standard error goes of processes that are started meanwhile."""
    kept = os.dup(2)
    with (tmp_path / "errors").open("w") as file:
        os.dup2(file.fileno(), 2)
        yield tmp_path / "errors"
    os.dup2(kept, 2)
    os.close(kept)


@pytest.fixture
def client(errors: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[TestClient]:
    monkeypatch.setenv(ENVIRONMENT, "json")
    app = create_app(Settings(home=tmp_path), bench_settings=in_process(f"watch-{os.getpid()}"))
    with TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as started:
        yield started


def samples(client: TestClient) -> dict[tuple[str, tuple[str, ...]], float]:
    """Scrape; each sample by its name and its labels' values."""
    answer = client.get("/metrics")
    assert answer.headers["Content-Type"] == "text/plain; version=0.0.4; charset=utf-8"
    families = text_string_to_metric_families(answer.text)
    return {
        (sample.name, tuple(sample.labels.values())): sample.value
        for family in families
        for sample in family.samples
    }


def test_metrics_readiness_and_log_of_a_run(
    errors: Path, client: TestClient, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "service")
    while (opening := client.get("/readyz")).status_code != 200:
        assert (opening.status_code, opening.json()["code"]) == (503, "bench-not-ready")
        time.sleep(0.05)
    assert opening.json()["bench"] == "reachable"
    place = start(client, SHORT)
    run = until(client, place, *FINAL)
    assert run["state"] == "succeeded"
    until(client, "/v1/bench", "idle")
    for _ in range(3):
        client.get(f"/v1/runs/{'0' * 32}")
    found = samples(client)
    assert found["darkflat_runs", ("succeeded",)] == 1
    assert found["darkflat_runs", ("running",)] == 0
    assert found["darkflat_jobs", ("queued",)] == 0
    assert found["darkflat_bench_state", ("idle",)] == 1
    assert found["darkflat_bench_state", ("busy",)] == 0
    assert found["darkflat_bench_reachable", ()] == 1
    assert found["darkflat_frames_total", ()] == run["result"]["frames"] == 16
    assert found["darkflat_lost_frames_total", ()] == 0
    assert found["darkflat_http_requests_total", ("GET", "/v1/runs/{run_id}", "404")] == 3
    asked = found["darkflat_http_request_seconds_count", ("GET", "/v1/runs/{run_id}")]
    assert asked >= 4
    for process in ("process", "darkflat_bench_process"):
        assert found[f"{process}_resident_memory_bytes", ()] > 1 << 20
        assert found[f"{process}_open_fds", ()] > 0

    lines = [json.loads(line) for line in errors.read_text().splitlines()]
    of_bench = [line for line in lines if line["process"] == "darkflat-bench"]
    assert [line["message"] for line in of_bench if line.get("run") == run["id"]] == [
        f"measuring into {run['id']}.h5"
    ]
    assert any("open and dark" in line["message"] and "run" not in line for line in of_bench)
    wanted = {
        "the run is submitted, by local", "the run has the bench", "the run is succeeded",
    }  # fmt: skip
    deadline = time.monotonic() + 30  # the last one is said once the state is on record
    while wanted != {r.getMessage() for r in caplog.records if getattr(r, "run", "") == run["id"]}:
        assert time.monotonic() < deadline, caplog.text
        time.sleep(0.02)
    about_runs = [r for r in caplog.records if r.name.startswith("service.runs")]
    assert all(getattr(record, "run", "") for record in about_runs)


def test_a_bench_that_died_is_not_ready(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    until(client, "/v1/bench", "idle")
    keeper = parts_of(client).keeper
    assert keeper is not None
    monkeypatch.setattr(keeper.owner, "open", lambda: None)  # so that it stays dead
    assert keeper.owner.pid is not None
    os.kill(keeper.owner.pid, 9)
    until(client, "/v1/bench", "closed")
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["code"]) == (503, "bench-not-ready")
    assert "died" in answer.json()["detail"]
    assert samples(client)["darkflat_bench_reachable", ()] == 0
    assert client.get("/healthz").status_code == 200


def test_a_route_is_counted_by_its_template_and_nonsense_as_one(client: TestClient) -> None:
    for name in ("a", "b"):
        client.get(f"/nowhere/{name}")
        client.request("NONSENSE" + name.upper(), "/healthz")
    found = samples(client)
    assert found["darkflat_http_requests_total", ("GET", "unknown", "404")] == 2
    names = {labels for name, labels in found if name == "darkflat_http_requests_total"}
    assert not any("NONSENSE" in method for method, *_ in names)


def test_apps_have_registries_of_their_own(tmp_path: Path) -> None:
    for name in ("a", "b"):
        app = create_app(Settings(home=tmp_path / name))
        with TestClient(app, base_url="http://127.0.0.1") as client:
            client.get("/healthz")
            found = samples(client)
        assert found["darkflat_http_requests_total", ("GET", "/healthz", "200")] == 1


def test_frames_of_attempts_add_up() -> None:
    def at(frames: int, lost: int) -> Progress:
        return Progress("running", 0, 4, frames, lost, None, "")

    count = FrameCount()
    for attempt in ((1, 0), (5, 2)), ((2, 1), (2, 1), (3, 1)):
        count.begin()
        for frames, lost in attempt:
            count.take(at(frames, lost))
    assert (count.kept, count.lost) == (8, 3)


@pytest.mark.parametrize("form", ["text", "json"])
def test_a_line_says_what_it_is_about_and_carries_its_trace(form: LogForm) -> None:
    made, subject = io.StringIO(), Subject()
    config = log_config(form, subject)
    formatter = config["formatters"][form]
    built = formatter["()"](formatter["format"]) if form == "text" else formatter["()"]()
    handler = logging.StreamHandler(made)
    handler.setFormatter(built)
    handler.addFilter(subject)
    logger = logging.Logger("service.test")
    logger.addHandler(handler)
    subject.run = "r1"
    logger.info("two\nlines")
    try:
        raise ValueError("why")
    except ValueError:
        logger.exception("failed", extra={"run": "r2"})
    subject.run = ""
    logger.info("of nothing")
    text = made.getvalue()
    if form == "text":
        assert "two\nlines [run r1]" in text
        assert "[run r2]" in text
        assert text.rstrip().endswith("service.test: of nothing")
        return
    lines = [json.loads(line) for line in text.splitlines()]
    assert [line.get("run") for line in lines] == ["r1", "r2", None]
    assert lines[0]["message"] == "two\nlines"
    assert "ValueError: why" in lines[1]["trace"]
