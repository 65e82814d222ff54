"""Comments after `<arg>` tags, written into the tags as `doc=`, which `roslaunch --ros-args` reads."""

import re
from xml.sax.saxutils import escape

from ur.docs.repository.comments import find_argument_comment
from ur.launchfile.syntax import Element, LaunchFile

_QUOTES = {'"': "&quot;"}
_ATTRIBUTE = re.compile(r"""(\s+)([^\s=>/"']+)(\s*=\s*)("[^"]*"|'[^']*')""")


def add_doc_attributes(tree: LaunchFile) -> str:
    """Return a launch file in which documented arguments have `doc=`; everything else stays unchanged.

    A comment takes precedence over a `doc=` with another text. A file that is not well-formed stays unchanged.
    """
    text = tree.source.text
    if tree.launch is None or tree.diagnostics:
        return text
    for element in reversed(list(tree.launch.elements)):  # from the end, so that places before stay
        if element.name != "arg" or not element.attributes.get("name"):
            continue
        comment = find_argument_comment(element, tree.launch)
        if comment is not None:
            text = _set_doc(text, element, make_doc(comment))
    return text


def make_doc(markdown: str) -> str:
    """Return a comment as the value of an attribute: one line, without anything that roslaunch would substitute."""
    return " ".join(markdown.split()).replace("$(", "$ (")


def _set_doc(text: str, element: Element, doc: str) -> str:
    if element.attributes.get("doc") == doc:
        return text
    written = f'"{escape(doc, _QUOTES)}"'
    position = element.start + 1 + len(element.name)
    space, end = " ", position
    while match := _ATTRIBUTE.match(text, position):
        if match.group(2) == "doc":
            return text[: match.start(4)] + written + text[match.end(4) :]
        space, end = match.group(1), match.end()
        position = match.end()
    return f"{text[:end]}{space if space.strip(' ') else ' '}doc={written}{text[end:]}"
