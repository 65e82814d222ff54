"""An argument is not documented."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import house_example, make_talk_launch
from ur.check.house import comments_after, heading_of, house_folder
from ur.check.model import Found, Group, LaunchView, Rule
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Severity


def _find_undocumented(view: LaunchView) -> Iterable[Found]:
    launch = view.tree.launch
    if launch is None or house_folder(view) is None:
        return
    tags: dict[str, list[Element]] = {}
    for element in launch.elements:
        if element.name == "arg" and element.attributes.get("name"):
            tags.setdefault(element.attributes["name"], []).append(element)
    for name, elements in tags.items():
        if not any(_is_documented(launch, element, name) for element in elements):
            yield Found(
                elements[-1].value_span("name"),
                f"argument '{name}' is not documented, expected a comment after it",
                f"write <!--{name}: ...--> in the next line",
            )


def _is_documented(launch: Element, element: Element, name: str) -> bool:
    if element.attributes.get("doc", "").strip():
        return True
    return any((name, True) == (heading[0], bool(heading[1])) for heading in _headings(launch, element))


def _headings(launch: Element, element: Element) -> list[tuple[str, str]]:
    return [heading for heading in map(heading_of, comments_after(launch, element)) if heading]


RULE = Rule(
    id="undocumented-argument",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="An argument is not documented.",
    explanation="""
After each `<arg>` follows `<!--name: ...-->`: what it means, in which unit, what it may be. `doc=` counts, too.
""",
    bad=(house_example(make_talk_launch('<arg name="«word»"/>', says="$(arg word)")),),
    good=(
        house_example(
            make_talk_launch(
                '<arg name="word"/>',
                "<!--word: What is said.-->",
                '<arg name="rate" default="1" doc="How often, in Hz."/>',
                says="$(arg word) $(arg rate)",
            )
        ),
    ),
    house=True,
    launch_file=_find_undocumented,
)
