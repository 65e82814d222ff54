"""A launch file does not read in the usual order."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import house_example, make_talk_launch
from ur.check.house import heading_of, house_folder
from ur.check.model import Found, Group, LaunchView, Rule
from ur.check.survey import find_uses
from ur.launchfile.syntax import Comment, Element
from ur.source.diagnostic import Note, Severity
from ur.source.file import Span

_KINDS = (
    "the Summary",
    "the Overview",
    "a required argument",
    "a convenience argument",
    "an optional argument",
    "the rest",
)
_HEADINGS = {"Summary": 0, "Overview": 1}
_REQUIRED, _CONVENIENCE, _OPTIONAL, _REST = 2, 3, 4, 5


def _find_disorder(view: LaunchView) -> Iterable[Found]:
    launch = view.tree.launch
    if launch is None or house_folder(view) is None:
        return
    optional: set[str] = set()  # and what is computed from optional arguments
    latest, latest_span = 0, launch.span
    for child in launch.children:
        if isinstance(child, Comment):
            heading = heading_of(child)
            kind = _HEADINGS.get(heading[0]) if heading else None
        else:
            kind = _kind_of(child)
            if kind in (_OPTIONAL, _CONVENIENCE) and (kind == _OPTIONAL or _depends_on(child, optional)):
                optional.add(child.attributes.get("name", ""))
                kind = max(kind, _OPTIONAL)
        if kind is None:
            continue
        if kind < latest:
            yield Found(
                _short_span(child),
                f"{_KINDS[kind]} after {_KINDS[latest]}, expected it before",
                "order: Summary, Overview, required, convenience (value=), optional (default=) arguments, the rest",
                (Note(f"{_KINDS[latest]} is here", latest_span),),
            )
            return
        if kind > latest:
            latest, latest_span = kind, _short_span(child)


def _kind_of(element: Element) -> int:
    if element.name != "arg":
        return _REST
    if "value" in element.attributes:
        return _CONVENIENCE
    return _OPTIONAL if "default" in element.attributes else _REQUIRED


def _depends_on(element: Element, names: set[str]) -> bool:
    return any(name in names for name, _ in find_uses(element))


def _short_span(child: Element | Comment) -> Span:
    if isinstance(child, Element):
        return child.span
    return Span(child.span.file, child.span.start, child.span.start + 4)


RULE = Rule(
    id="file-order",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A launch file does not read in the usual order.",
    explanation="""
Summary, Overview, required arguments, convenience arguments (`value=`), optional arguments (`default=`), the rest: who
opens a file finds first what has to be given. A convenience argument that is computed from an optional one may follow
it.
""",
    bad=(
        house_example(
            make_talk_launch(
                '<arg name="rate" default="1"/>',
                "<!--rate: How often, in Hz.-->",
                '«<arg» name="word"/>',
                "<!--word: What is said.-->",
                says="$(arg word) $(arg rate)",
            )
        ),
    ),
    good=(
        house_example(
            make_talk_launch(
                '<arg name="word"/>',
                "<!--word: What is said.-->",
                '<arg name="rate" default="1"/>',
                "<!--rate: How often, in Hz.-->",
                '<arg name="words" value="$(arg word) $(arg rate)"/>',
                "<!--words: The program's arguments.-->",
                says="$(arg words)",
            )
        ),
    ),
    house=True,
    launch_file=_find_disorder,
)
