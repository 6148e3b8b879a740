"""Entity tags: RFC 9110, section 8.8.3."""


def quoted(tag: str) -> str:
    """Return `tag` as a strong entity tag."""
    return f'"{tag}"'


def matches(if_none_match: str | None, tag: str) -> bool:
    """Tell whether an `If-None-Match` names `tag`; weak comparison, as that header wants.

    >>> matches('W/"a", "b"', "b"), matches('"a"', "b"), matches("*", "b"), matches(None, "b")
    (True, False, True, False)
    """
    if if_none_match is None:
        return False
    given = [each.strip().removeprefix("W/") for each in if_none_match.split(",")]
    return "*" in given or quoted(tag) in given
