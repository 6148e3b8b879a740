"""The look that reports share, as the text of a page's `<style>`."""

from importlib.resources import files

from markupsafe import Markup


def page_style() -> Markup:
    """Return the style sheet; it names no other file, so a page of it needs nothing but itself."""
    text = files("calib.report").joinpath("page.css").read_text("utf-8")
    # Our own file, not text from outside: it may stand unescaped.
    return Markup(text)  # noqa: S704
