"""Words that name no thing do not stand in names and docstrings: `the client`, `the node`, `ended`, `received` do."""

from __future__ import annotations

import re
from collections.abc import Mapping

from tests.form.facts import ROOT, Facts

WORDS = (
    "whoever|whatever|nobody|somebody|anybody|everybody|anyone|everyone|someone|whom|"
    "gone|said|told|came|hear|hears|heard|wishes|happenings|teller"
)
_IN_TEXT = re.compile(rf"\b({WORDS})\b", re.IGNORECASE)
_IN_NAME = re.compile(rf"(?:^|_)({WORDS})(?:_|$)", re.IGNORECASE)
_HUMP = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_CODE = re.compile(r"`[^`]*`")


def test_names_and_docstrings_name_the_thing(modules: Mapping[str, Facts]) -> None:
    wrong = {}
    for path, each in modules.items():
        names = [name for name in each.names if _IN_NAME.search(_HUMP.sub("_", name))]
        texts = [text for text in each.docstrings if _IN_TEXT.search(_CODE.sub("", text))]
        if names or texts:
            wrong[path] = [*names, *texts]
    assert wrong == {}


def test_texts_of_the_page_name_the_thing() -> None:
    lines = (ROOT / "src" / "ur" / "web" / "static" / "texts.js").read_text(encoding="utf-8").splitlines()
    assert not [line for line in lines if _IN_TEXT.search(line)]
