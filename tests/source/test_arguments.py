import re
from pathlib import Path

import pytest

from ur.source.arguments import Argument, parse_argument, split_argv, values_of

ROOT = Path(__file__).parents[2]


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
    line = split_argv(["p", "b:=1", "f.launch", "a:=2", "b:=3"])
    assert line.names == ("p", "f.launch")
    assert line.argv == ("p", "f.launch", "b:=1", "a:=2", "b:=3")
    assert line.values == values_of(line.arguments) == {"b": "3", "a": "2"}


def test_arguments_are_split_in_one_place() -> None:
    texts = {path: path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py")}
    found = [path for path, text in texts.items() if re.search(r"""partition\([^)]*":="|split\(":="|ASSIGN\)""", text)]
    assert found == [ROOT / "src/ur/source/arguments.py"]
