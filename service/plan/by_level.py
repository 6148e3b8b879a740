"""Tables whose keys are levels."""

from typing import Any


def levels_quoted(table: Any) -> Any:
    """Refuse what TOML makes of `0.5 = 3.0`: a table 0 with a key 5, not the level 0.5."""
    if isinstance(table, dict):
        for level, value in table.items():
            if isinstance(value, dict):
                split = f"{level}.{next(iter(value), '')}"
                msg = f'a level with a point needs quotes in TOML: "{split}" = …'
                raise ValueError(msg)
    return table
