"""A comment documents an argument that does not exist."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import house_example, make_talk_launch
from ur.check.house import KNOWN_HEADINGS, heading_of, house_folder
from ur.check.model import Found, Group, LaunchView, Rule
from ur.launchfile.syntax import Comment, Element
from ur.source.diagnostic import Severity
from ur.source.file import Span
from ur.source.suggest import did_you_mean


def _find_unknown_documentation(view: LaunchView) -> Iterable[Found]:
    launch = view.tree.launch
    if launch is None or house_folder(view) is None:
        return
    after_arg = False
    for child in launch.children:
        if isinstance(child, Element):
            after_arg = child.name == "arg"
            continue
        heading = heading_of(child)
        if heading is None or heading[0] in view.declared or heading[0].lower() in KNOWN_HEADINGS:
            continue
        # A comment of another kind may hold a colon, too: a name has no capital, and stands after an <arg>.
        near = did_you_mean(heading[0], view.declared)
        if near or (after_arg and heading[0].islower()):
            yield Found(
                _name_span(child, heading[0]),
                f"'{heading[0]}' is documented, and there is no argument of this name",
                f"did you mean {near}?" if near else "remove the comment, or declare the argument",
            )


def _name_span(comment: Comment, name: str) -> Span:
    start = comment.span.file.text.find(name, comment.span.start)
    return Span(comment.span.file, start, start + len(name))


RULE = Rule(
    id="unknown-documentation",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A comment documents an argument that does not exist.",
    explanation="""
A comment `<!--name: ...-->` is about the argument `name`. Where there is none, the argument was renamed or removed, or
the comment is misspelt.
""",
    bad=(
        house_example(
            make_talk_launch(
                '<arg name="word"/>',
                "<!--word: What is said.-->",
                "<!--«volume»: How loud it is said.-->",
                says="$(arg word)",
            )
        ),
    ),
    good=(
        house_example(
            make_talk_launch(
                '<arg name="word"/>',
                "<!--word: What is said.-->",
                "<!-- Note: the rest is for listeners. -->",
                says="$(arg word)",
            )
        ),
    ),
    house=True,
    launch_file=_find_unknown_documentation,
)
