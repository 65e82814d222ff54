"""The text of a launch file that follows the conventions of `ur check`."""

from collections.abc import Iterable, Iterator, Sequence
from textwrap import fill
from xml.sax.saxutils import escape, quoteattr

from ur.tools.new.parts import NewArgument

_WIDTH = 118
LOCALHOST = (
    "<!-- roslaunch knows no machine by itself, not even this one; saying it twice does no harm. -->",
    '<machine name="localhost" address="localhost"/>',
)
MACHINE = NewArgument("machine", "Where the node runs.", default="localhost")


def write_launch(summary: str, overview: str, arguments: Sequence[NewArgument], body: Iterable[str]) -> str:
    """Return a launch file: Summary, Overview, arguments by kind with documentation, and the lines of the rest."""
    lines = ["<launch>", f"  <!--Summary: {as_comment(summary)}-->"]
    paragraph = fill(as_comment(overview), _WIDTH - 4, break_long_words=False, break_on_hyphens=False)
    lines += ["  <!--Overview:", *(f"    {line}" for line in paragraph.splitlines()), "  -->"]
    for title, kind in (("Required", "required"), ("Convenience", "value"), ("Optional", "default")):
        chosen = [each for each in arguments if _kind(each) == kind]
        if chosen:
            lines += [
                "",
                f"  <!-- {title} arguments -->",
                *(f"  {line}" for each in chosen for line in _argument(each)),
            ]
    lines += ["", *(f"  {line}" for line in body), "</launch>", ""]
    return "\n".join(lines)


def attribute(name: str, value: str) -> str:
    """Return `name="value"`, escaped."""
    return f"{name}={quoteattr(value)}"


def as_comment(text: str) -> str:
    """Return a text as valid content of a comment: in one line, without two dashes in a row."""
    words = " ".join(text.split())
    while "--" in words:
        words = words.replace("--", "-")
    return words.removesuffix("-")


def hand_on(names: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield the `<arg>` tags of an include, which pass on arguments (theirs, ours)."""
    yield from (f'  <arg name="{theirs}" value="$(arg {ours})"/>' for theirs, ours in names)


def _kind(argument: NewArgument) -> str:
    if argument.value is not None:
        return "value"
    return "required" if argument.default is None else "default"


def _argument(argument: NewArgument) -> Iterator[str]:
    given = ""
    if argument.value is not None:
        given = " " + attribute("value", argument.value)
    elif argument.default is not None:
        given = " " + attribute("default", argument.default)
    yield f'<arg name="{escape(argument.name)}"{given}/>'
    yield f"<!--{argument.name}: {as_comment(argument.doc)}-->"
