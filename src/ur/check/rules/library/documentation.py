"""Rules about the documentation comments of a launch file."""

from collections.abc import Iterable

from ur.check.example_parts import (
    MARKED_LAUNCH,
    OVERVIEW,
    SUMMARY,
    TALKER,
    directory_example,
    make_launch,
    make_talk_launch,
)
from ur.check.queries.layout import KNOWN_HEADINGS, comments_after, find_heading, heading_of, launch_directory
from ur.check.rule import LaunchView, Rule, RuleFinding, RuleGroup
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Severity
from ur.source.file import Span
from ur.source.suggest import did_you_mean


def _find_missing_overview(view: LaunchView) -> Iterable[RuleFinding]:
    launch = view.tree.launch
    if launch is not None and launch_directory(view) is not None and not find_heading(view, "Overview"):
        yield RuleFinding(
            launch.span,
            "a launch file without an Overview, expected a few sentences, in Markdown, on how the file is used",
            "write <!--Overview: ...--> after <launch>",
            subject="Overview",
        )


def _find_missing_summary(view: LaunchView) -> Iterable[RuleFinding]:
    launch = view.tree.launch
    if launch is not None and launch_directory(view) is not None and not find_heading(view, "Summary"):
        yield RuleFinding(
            launch.span,
            "a launch file without a Summary, expected one line that says what the file does",
            "write <!--Summary: ...--> after <launch>",
            subject="Summary",
        )


def _find_undocumented(view: LaunchView) -> Iterable[RuleFinding]:
    launch = view.tree.launch
    if launch is None or launch_directory(view) is None:
        return
    tags: dict[str, list[Element]] = {}
    for element in launch.elements:
        if element.name == "arg" and element.attributes.get("name"):
            tags.setdefault(element.attributes["name"], []).append(element)
    for name, elements in tags.items():
        if not any(_is_documented(launch, element, name) for element in elements):
            yield RuleFinding(
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


def _find_unknown_documentation(view: LaunchView) -> Iterable[RuleFinding]:
    launch = view.tree.launch
    if launch is None or launch_directory(view) is None:
        return
    after_arg = False
    for child in launch.children:
        if isinstance(child, Element):
            after_arg = child.name == "arg"
            continue
        heading = heading_of(child)
        if heading is None or heading[0] in view.declared or heading[0].lower() in KNOWN_HEADINGS:
            continue
        # Other comments may contain a colon, too: a name has no capital letter, and follows an <arg>.
        near = did_you_mean(heading[0], view.declared)
        if near or (after_arg and heading[0].islower()):
            name = heading[0]
            start = child.span.file.text.find(name, child.span.start)
            yield RuleFinding(
                Span(child.span.file, start, start + len(name)),
                f"'{heading[0]}' is documented, and there is no argument of this name",
                f"did you mean {near}?" if near else "remove the comment, or declare the argument",
            )


RULES = (
    Rule(
        id="missing-overview",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A launch file has no Overview.",
        explanation="""
`<!--Overview: ...-->` is a few sentences, in Markdown, on how the file is used. The generated pages begin with it.
""",
        bad=(directory_example(make_launch(SUMMARY, TALKER, tag=MARKED_LAUNCH)),),
        good=(directory_example(make_talk_launch()),),
        launch_file=_find_missing_overview,
    ),
    Rule(
        id="missing-summary",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A launch file has no Summary.",
        explanation="""
`<!--Summary: ...-->` is one line that says what the file does. Lists of launch files show it.
""",
        bad=(directory_example(make_launch(OVERVIEW, TALKER, tag=MARKED_LAUNCH)),),
        good=(directory_example(make_talk_launch()),),
        launch_file=_find_missing_summary,
    ),
    Rule(
        id="undocumented-argument",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="An argument is not documented.",
        explanation="""
After each `<arg>` follows `<!--name: ...-->`: what it means, in which unit, what it may be. `doc=` counts, too.
""",
        bad=(directory_example(make_talk_launch('<arg name="«word»"/>', says="$(arg word)")),),
        good=(
            directory_example(
                make_talk_launch(
                    '<arg name="word"/>',
                    "<!--word: What is said.-->",
                    '<arg name="rate" default="1" doc="How often, in Hz."/>',
                    '<arg name="words" value="$(arg word) $(arg rate)" doc="The program\'s arguments."/>',
                    says="$(arg words)",
                )
            ),
        ),
        launch_file=_find_undocumented,
    ),
    Rule(
        id="unknown-documentation",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A comment documents an argument that does not exist.",
        explanation="""
A comment `<!--name: ...-->` is about the argument `name`.
""",
        bad=(
            directory_example(
                make_talk_launch(
                    '<arg name="word"/>',
                    "<!--word: What is said.-->",
                    "<!--«volume»: How loud it is said.-->",
                    says="$(arg word)",
                )
            ),
        ),
        good=(
            directory_example(
                make_talk_launch(
                    '<arg name="word"/>',
                    "<!--word: What is said.-->",
                    "<!-- Note: the rest is for listeners. -->",
                    says="$(arg word)",
                )
            ),
        ),
        launch_file=_find_unknown_documentation,
    ),
)
