"""Docstrings are contracts: a noun phrase or an imperative verb, never an indirect question.

A method that implements a documented one needs none of its own: its contract is that of the protocol.
"""

import ast
from collections.abc import Mapping

from tests.form.facts import Facts

QUESTIONS = {
    *("What", "Which", "How", "Whether", "Who", "Whose", "Where", "Why", "When"),
    *("Is", "Are", "Has", "Can", "Does"),
}


def test_public_methods_have_a_docstring_or_implement_one_that_has(modules: Mapping[str, Facts]) -> None:
    methods = [(path, name, documented) for path, each in modules.items() for name, documented in each.methods]
    visitors = {f"visit_{name}" for name in dir(ast)}  # documented by Python
    known = {name for _, name, documented in methods if documented} | visitors
    assert [f"{path} {name}" for path, name, _ in methods if name not in known] == []


def test_no_docstring_begins_with_a_question_word(modules: Mapping[str, Facts]) -> None:
    wrong = {
        path: questions
        for path, each in modules.items()
        if (questions := [text for text in each.docstrings if text.split()[0].rstrip(",:") in QUESTIONS])
    }
    assert wrong == {}
