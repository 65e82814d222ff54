"""Rules about the names and the order of launch files."""

from collections.abc import Iterable

from ur.check.example_parts import (
    MARKED_LAUNCH,
    PROGRAM_HEAD,
    SUMMARY,
    directory_example,
    make_launch,
    make_talk_launch,
)
from ur.check.queries.layout import file_name, heading_of, launch_directory
from ur.check.rule import Example, LaunchView, PackageView, Rule, RuleFinding, RuleGroup
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


def _find_disorder(view: LaunchView) -> Iterable[RuleFinding]:
    launch = view.tree.launch
    if launch is None or launch_directory(view) is None:
        return
    optional: set[str] = set()  # and what is computed from optional arguments
    latest, latest_span = 0, launch.span
    for child in launch.children:
        if isinstance(child, Comment):
            heading = heading_of(child)
            kind = _HEADINGS.get(heading[0]) if heading else None
        else:
            kind = _kind_of(child)
            if kind == _OPTIONAL or (kind == _CONVENIENCE and any(name in optional for name, _ in find_uses(child))):
                optional.add(child.attributes.get("name", ""))
                kind = max(kind, _OPTIONAL)
        if kind is None:
            continue
        if kind < latest:
            yield RuleFinding(
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


def _short_span(child: Element | Comment) -> Span:
    if isinstance(child, Element):
        return child.span
    return Span(child.span.file, child.span.start, child.span.start + 4)


_SUFFIXES = (".launch.xml", ".launch")


def _find_other_name(view: LaunchView) -> Iterable[RuleFinding]:
    folder, name = launch_directory(view), file_name(view)
    if folder is None or view.tree.launch is None or not name.endswith(_SUFFIXES):
        return
    suffix = next(suffix for suffix in _SUFFIXES if name.endswith(suffix))
    if name != folder + suffix:
        yield RuleFinding(
            view.tree.launch.span,
            f"the file is named {name}, expected {folder}{suffix} in {folder}/launch",
            f"rename it, or move it into a directory {name.removesuffix(suffix)}",
            subject=name,
        )


def _find_wrong_suffix(view: PackageView) -> Iterable[RuleFinding]:
    for launch_view in view.launch_files:
        name = file_name(launch_view)
        if launch_directory(launch_view) is None or name.endswith(".launch.xml"):
            continue
        launch = launch_view.tree.launch
        if launch is None:
            continue
        if not name.endswith(".launch"):
            yield RuleFinding(
                launch.span,
                f"{name} holds a <launch>, expected the ending .launch or .launch.xml",
                "rename it",
                subject=name,
            )
        elif launch_view.path in view.included:
            place = view.included[launch_view.path][0]
            yield RuleFinding(
                launch.span,
                f"{name} is included by another file, expected the ending .launch.xml",
                f"rename it to {name}.xml: .launch is for files that people start",
                (Note("it is included here", place),),
                name,
            )


def _suffix_example(suffix: str, part: str) -> Example:
    included = f"n_talker/launch/n_talker.{suffix}"
    whole = make_launch(
        SUMMARY, "<!--Overview: Includes what says it.-->", f'<include file="$(find my_robot)/{included}"/>'
    )
    return Example({"m_talk/launch/m_talk.launch": whole, included: part})


def _find_unused_file(view: PackageView) -> Iterable[RuleFinding]:
    for launch_view in view.launch_files:
        name = file_name(launch_view)
        if launch_directory(launch_view) is None or not name.endswith(".launch.xml"):
            continue
        started = any(name in program.source.text for program in view.programs)
        launch = launch_view.tree.launch if launch_view.path not in view.included and not started else None
        if launch is not None:
            yield RuleFinding(
                launch.span,
                f"nothing uses {name}, expected a launch file that includes it or a program that starts it",
                f"include it, write bin/ur_..., or rename it to {name.removesuffix('.xml')}: people start those",
                subject=name,
            )


_INCLUDED_PATH = "n_talker/launch/n_talker.launch.xml"
_PROGRAM = PROGRAM_HEAD + 'exec roslaunch my_robot n_talker.launch.xml "$@"\n'


RULES = (
    Rule(
        id="file-order",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A launch file does not read in the usual order.",
        explanation="""
Summary, Overview, required arguments, convenience arguments (`value=`), optional arguments (`default=`), the rest: who
opens a file finds first what has to be given. A convenience argument that is computed from an optional one may follow
it.
""",
        bad=(
            directory_example(
                make_talk_launch(
                    '<arg name="rate" default="1"/>',
                    "<!--rate: How often, in Hz.-->",
                    '«<arg» name="word"/>',
                    "<!--word: What is said.-->",
                    '<arg name="words" value="$(arg word) $(arg rate)"/>',
                    "<!--words: The program's arguments.-->",
                    says="$(arg words)",
                )
            ),
        ),
        good=(
            directory_example(
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
        launch_file=_find_disorder,
    ),
    Rule(
        id="launch-file-name",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A launch file is not named as its directory.",
        explanation="""
A directory `n_x`, `m_x` or `rviz_x` holds one launch file of this name, so that each of the two tells the other.
""",
        bad=(directory_example(make_talk_launch(tag=MARKED_LAUNCH), "talker.launch"),),
        good=(directory_example(make_talk_launch()),),
        launch_file=_find_other_name,
    ),
    Rule(
        id="launch-suffix",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A launch file's ending does not say what it is for.",
        explanation="""
`.launch` files are started by people and complete with Tab; `.launch.xml` files are included by others.
""",
        bad=(_suffix_example("launch", make_talk_launch(tag=MARKED_LAUNCH)),),
        good=(_suffix_example("launch.xml", make_talk_launch()),),
        whole_package=_find_wrong_suffix,
    ),
    Rule(
        id="unused-launch-file",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="Nothing uses a launch file.",
        explanation="""
A `.launch.xml` file is there to be included, or to be started by a program in `bin`. Only looked at when the whole
package is checked.
""",
        bad=(Example({_INCLUDED_PATH: make_talk_launch(tag=MARKED_LAUNCH)}),),
        good=(Example({_INCLUDED_PATH: make_talk_launch(), "bin/ur_talk": _PROGRAM}),),
        whole_package=_find_unused_file,
    ),
)
