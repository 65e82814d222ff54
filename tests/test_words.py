"""Words that name no thing do not stand in names and docstrings: `the client`, `the node`, `ended`, `received` do."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from tests.test_docstrings import MODULES, SRC, docstrings_of

WORDS = (
    "whoever|whatever|nobody|somebody|anybody|everybody|anyone|everyone|someone|whom|"
    "gone|said|told|came|hear|hears|heard|wishes|happenings|teller"
)
_IN_TEXT = re.compile(rf"\b({WORDS})\b", re.IGNORECASE)
_IN_NAME = re.compile(rf"(?:^|_)({WORDS})(?:_|$)", re.IGNORECASE)
_IN_SOURCE = re.compile(rf"(?i:{WORDS})(?![a-z])")  # wherever one of the two above finds something
_HUMP = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_CODE = re.compile(r"`[^`]*`")


def names_of(path: Path) -> Iterator[str]:
    """The names that a module gives: of functions, classes, arguments and variables."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr


def test_names_and_docstrings_name_the_thing() -> None:
    wrong = {}
    for path in MODULES:
        if not _IN_SOURCE.search(path.read_text(encoding="utf-8")):
            continue
        names = [name for name in names_of(path) if _IN_NAME.search(_HUMP.sub("_", name))]
        texts = [text for text in docstrings_of(path) if _IN_TEXT.search(_CODE.sub("", text))]
        if names or texts:
            wrong[path.relative_to(SRC).as_posix()] = [*names, *texts]
    assert wrong == {}


def test_texts_of_the_page_name_the_thing() -> None:
    lines = (SRC / "ur" / "web" / "static" / "texts.js").read_text(encoding="utf-8").splitlines()
    assert not [line for line in lines if _IN_TEXT.search(line)]
