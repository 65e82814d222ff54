"""Words that name no thing do not stand in names and docstrings: `the client`, `the node`, `ended`, `received` do."""

import re
from collections.abc import Mapping

from tests.form.facts import ROOT, Facts

WORDS = (
    "whoever|whatever|nobody|somebody|anybody|everybody|anyone|everyone|someone|whom|"
    "gone|said|told|came|hear|hears|heard|wishes|happenings|teller"
)
DIALECT = "take(?!_over)|takes|taker|takers|lane|lanes|greet|tape|lay(?!_?out)|laid"
OF_TOPICS = "offer|offers|listener|listeners"
"""Words that ROS has names for: publisher, subscriber."""
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


def test_public_names_are_terms_of_the_field(modules: Mapping[str, Facts]) -> None:
    """`take`: on_scan, handle_goal, or the verb that it means; `lane`: queue; `greet`: handshake; `_end`: endpoint."""
    wrong = {}
    for path, each in modules.items():
        words = f"{DIALECT}|{OF_TOPICS}" if path.startswith("ur_nodes/") else DIALECT
        pattern = re.compile(rf"(?:^|_)({words})(?:_|$)", re.IGNORECASE)
        module = path.rpartition("/")[2].removesuffix(".py")
        names = {name for name in each.public_names if pattern.search(_HUMP.sub("_", name))}
        found = sorted(names)
        if found or re.search(r"_end(_node)?$", module):
            wrong[path] = found
    assert wrong == {}
