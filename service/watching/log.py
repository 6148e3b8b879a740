"""The log: lines on standard error, for people or for programs; each says which run it is about."""

import json
import logging
import logging.config
import os
from datetime import UTC, datetime
from typing import Any, Literal, cast

LogForm = Literal["text", "json"]
ENVIRONMENT = "DARKFLAT_LOG"
"""Tells the form to the processes that the service starts."""
_SUBJECTS = ("run", "job")


class Subject(logging.Filter):
    """What this process works on; each line that does not say so itself is given it.

    Attributes:
        run: The run's id; empty where there is none.
        job: The job's id; empty where there is none.
    """

    run = ""
    job = ""

    def filter(self, record: logging.LogRecord) -> bool:
        """Let every line pass, with its subject."""
        for name in _SUBJECTS:
            if not hasattr(record, name):
                setattr(record, name, getattr(self, name))
        return True


class TextLines(logging.Formatter):
    """Lines for people."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, and a trace below it where there is one."""
        text = super().format(record)
        subjects = [f"{name} {getattr(record, name, '')}" for name in _subjects(record)]
        return f"{text} [{', '.join(subjects)}]" if subjects else text


class JsonLines(logging.Formatter):
    """One JSON object per line."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line; a trace is one of its members."""
        at = datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
        line: dict[str, Any] = {
            "at": at,
            "level": record.levelname.lower(),
            "logger": record.name,
            "process": record.processName,
            "message": record.getMessage(),
        }
        line |= {name: getattr(record, name) for name in _subjects(record)}
        if record.exc_info:
            line["trace"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False)


def log_config(form: LogForm, subject: Subject) -> dict[str, Any]:
    """Return the configuration of `logging` and of uvicorn; standard output is the answer's."""
    formatters = {
        "text": {"()": TextLines, "format": "%(asctime)s %(levelname)s %(name)s: %(message)s"},
        "json": {"()": JsonLines},
    }
    handler = {
        "class": "logging.StreamHandler",
        "formatter": form,
        "filters": ["subject"],
        "stream": "ext://sys.stderr",
    }
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "filters": {"subject": {"()": lambda: subject}},
        "formatters": formatters,
        "handlers": {"error": handler},
        "loggers": {
            "uvicorn": {"handlers": ["error"], "level": "WARNING", "propagate": False},
            "service": {"level": "INFO"},
        },
        "root": {"handlers": ["error"], "level": "WARNING"},
    }


def log_of_child() -> Subject:
    """Log as the service does that started this process; return what its lines are about."""
    form = "json" if os.environ.get(ENVIRONMENT) == "json" else "text"
    subject = Subject()
    logging.config.dictConfig(log_config(cast("LogForm", form), subject))
    logging.captureWarnings(capture=True)
    return subject


def _subjects(record: logging.LogRecord) -> list[str]:
    return [name for name in _SUBJECTS if getattr(record, name, "")]
