"""A bench by the client: runs, what they say, how the bench is, every lamp off."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.app import create_app
from service.client import Client, WorkFailedError
from service.settings import Settings
from tests.service.client.answering import asking
from tests.service.client.darkness import wait_until
from tests.service.owner.serving import slow_plan
from tests.service.sequencer.benches import in_process, short_plan

SLOW = slow_plan().model_dump(mode="json")
SHORT = short_plan().model_dump(mode="json")


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    settings = Settings(home=tmp_path_factory.mktemp("home"))
    bench = in_process(f"client-{os.getpid()}")
    with asking(create_app(settings, bench_settings=bench)) as client:
        wait_until(lambda: client.bench.get().state == "idle")
        yield client


def state_of(client: Client, run_id: str) -> str:
    return client.runs.get(run_id).state


def test_what_a_run_says_is_the_same_whole_in_part_and_afterwards(
    client: Client, tmp_path: Path
) -> None:
    assert len(client.runs.validate(SHORT).steps) == 4
    run = client.runs.start(SHORT, idempotency_key="nightly")
    followed = list(client.runs.follow(run.id))
    ended = client.runs.wait(run.id)
    assert (ended.state, ended.blocks_done) == ("succeeded", 4)
    assert followed == list(client.runs.journal(run.id))
    assert followed[3:] == list(client.runs.follow(run.id, after=3))
    assert followed[3:] == list(client.runs.journal(run.id, after=3))
    assert client.runs.start(SHORT, idempotency_key="nightly") == ended
    assert [each.id for each in client.runs.all(state="succeeded")] == [run.id]
    assert ended.recording is not None
    assert client.recordings.download(ended.recording, tmp_path / "run.zip").stat().st_size


def test_a_run_is_held_let_go_on_and_ended_and_the_bench_looked_at(client: Client) -> None:
    run = client.runs.start(SLOW)
    wait_until(lambda: state_of(client, run.id) == "running")
    assert client.bench.get().run == run.id
    client.runs.pause(run.id)
    wait_until(lambda: state_of(client, run.id) == "paused")
    light = next(each for each in client.bench.look() if each.role == "light")
    assert light.values["level"] == 0.0
    assert client.runs.resume(run.id).state == "running"
    client.runs.abort(run.id)
    with pytest.raises(WorkFailedError) as failed:
        client.runs.wait(run.id)
    assert (failed.value.code, failed.value.state) == ("run-cancelled", "cancelled")


def test_safe_off_reads_back_and_the_service_is_well(client: Client) -> None:
    off = client.bench.safe_off()
    assert off.dark
    assert client.safe_off()
    assert "light" in {each.role for each in off.devices}
    kept = client.bench.get().kept_dark
    assert kept is not None
    assert kept.by == "local"
    assert client.bench.release().kept_dark is None
    assert client.health.alive().status == "alive"
    assert client.health.ready().bench == "reachable"
    assert 'darkflat_runs{state="succeeded"}' in client.health.metrics()
