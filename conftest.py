"""Keeps the doctests' collector from Alembic's env.py, which only runs inside a migration.

It lies here and not beside env.py because whatever lies inside a package is installed with it.
"""

collect_ignore = ["service/store/migrations/env.py"]
