"""How many runs and jobs are on record, by state."""

from typing import get_args

from sqlalchemy import Engine, func, select

from service.store.engine import reading_session
from service.store.records import JobState
from service.store.run_records import RunState
from service.store.tables import JobRow, RunRow


class Counts:
    """Of each state, those of which there are none too."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def runs(self) -> dict[str, int]:
        """Return how many runs are in each state."""
        return dict.fromkeys(get_args(RunState), 0) | self._by_state(RunRow)

    def jobs(self) -> dict[str, int]:
        """Return how many jobs are in each state."""
        return dict.fromkeys(get_args(JobState), 0) | self._by_state(JobRow)

    def _by_state(self, table: type[RunRow | JobRow]) -> dict[str, int]:
        with reading_session(self._engine) as session:
            rows = session.execute(select(table.state, func.count()).group_by(table.state))
            return {state: count for state, count in rows}  # noqa: C416  (rows are no pairs to mypy)
