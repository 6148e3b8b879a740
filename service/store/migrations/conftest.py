"""Keeps the doctests' collector from Alembic's env.py, which only runs inside a migration."""

collect_ignore_glob = ["env.py"]
