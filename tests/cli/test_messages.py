"""Every message of the verbs on wrong input is as agreed in messages.txt."""

import re

from tests.cli.wrong_inputs import GOLDEN, describe_messages, list_commands, list_lines

from ur.cli.verbs import VERBS

HINT = "read the difference against the rules of writing, then run: .venv/bin/python tools/list_messages.py --update"


def test_messages_on_wrong_input_are_as_agreed() -> None:
    assert describe_messages() == GOLDEN.read_text(encoding="utf-8"), HINT


def test_every_verb_has_a_wrong_input() -> None:
    assert {words[0] for words in list_lines()} >= set(VERBS)
    assert {path[0] for path, _ in list_commands()} == set(VERBS)


def test_no_message_is_a_traceback_or_an_internal_error() -> None:
    text = GOLDEN.read_text(encoding="utf-8")
    assert "Traceback" not in text
    assert "internal error" not in text


def test_no_message_begins_with_a_question_word() -> None:
    messages = re.findall(r"error: (.*)", GOLDEN.read_text(encoding="utf-8"))
    assert len(messages) > 300
    assert not [each for each in messages if re.match(r"(?i)(what|which|how|whether|who)\b", each)]
