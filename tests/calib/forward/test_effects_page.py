"""docs/effects.md says of every effect what the effect says of itself."""

from tests.calib.forward.effects_page import BEGIN, PAGE, WRITE_ANEW, table


def test_the_page_holds_every_effect_as_it_is() -> None:
    assert PAGE.read_text(encoding="utf-8").split(BEGIN)[1] == table(), f"write anew: {WRITE_ANEW}"
