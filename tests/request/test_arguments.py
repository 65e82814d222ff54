from __future__ import annotations

import pytest

from ur.request.arguments import Argument, parse_argument, split_argv, values_of


@pytest.mark.parametrize(
    ("text", "argument"),
    [
        ("a:=1", Argument("a", "1")),
        ("a:=", Argument("a", "")),
        (":=1", Argument("", "1")),
        ("a:=b:=c", Argument("a", "b:=c")),
        ("a=1", None),
        ("a:1", None),
        ("-", None),
    ],
)
def test_argument_is_split_at_its_first_assignment(text: str, argument: Argument | None) -> None:
    assert parse_argument(text) == argument
    assert argument is None or str(argument) == text


def test_names_and_arguments_keep_their_order() -> None:
    names, arguments = split_argv(["p", "b:=1", "f.launch", "a:=2", "b:=3"])
    assert names == ["p", "f.launch"]
    assert [str(each) for each in arguments] == ["b:=1", "a:=2", "b:=3"]
    assert values_of(arguments) == {"b": "3", "a": "2"}
