"""Bad input, case by case: exit status 1, one sentence, a stable code, nothing left behind."""

import re
from pathlib import Path

import pytest

from tests.test_bad_input.case import Case
from tests.test_bad_input.catalogue import CASES
from tests.test_bad_input.running import run
from tests.test_bad_input.table import WRITE_ANEW, Row, cell, rows

SECOND_SENTENCE = re.compile(r"[.?!] [A-Z]")
NO_SENTENCE = re.compile(r"Traceback|Error\(|\[Errno|errors\.pydantic\.dev|0x[0-9a-f]{6}")


@pytest.mark.parametrize("case", CASES, ids=[case.situation for case in CASES])
def test_bad_input_is_refused_in_one_sentence_and_leaves_nothing(
    case: Case, sound: Path, tmp_path: Path
) -> None:
    ran = run(case, sound, tmp_path)
    assert ran.status == 1, ran.stdout + ran.stderr
    code, sentence = ran.error["code"], ran.error["message"]
    assert ran.stderr == f"darkflat: {sentence}\n"
    assert code == case.code
    for words in (*case.where, case.remedy):
        assert words in sentence
    assert not SECOND_SENTENCE.search(sentence)
    assert not NO_SENTENCE.search(sentence)
    assert ran.after == ran.before
    row = Row(case.situation, case.command, cell(sentence), code)
    assert rows().get(case.situation) == row, f"the page is stale: {WRITE_ANEW}"


def test_the_page_has_no_row_that_no_case_stands_for() -> None:
    assert list(rows()) == [case.situation for case in CASES]


def test_each_situation_is_told_once_and_each_sentence_says_where_and_what_to_do() -> None:
    assert len({case.situation for case in CASES}) == len(CASES)
    for case in CASES:
        assert all(case.where), case.situation
        assert case.remedy, case.situation
