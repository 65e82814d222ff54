"""Rules about files: YAML, and files and includes that the parser and resolver of launch files report."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from ur.check.example_parts import make_launch
from ur.check.rule import Example, Rule, RuleFinding, RuleGroup, YamlView, launch_example, launch_examples
from ur.launchfile.plan.values.yaml_values import MAX_VALUES
from ur.source.diagnostic import Note, Severity
from ur.source.file import SourceFile, Span

if TYPE_CHECKING:
    import yaml  # imported where there is such a file: it takes a tenth of a check


def _find_bad_yaml(view: YamlView) -> Iterable[RuleFinding]:
    source = view.source
    if not is_plain_yaml(source):
        return
    import yaml

    from ur.source.foreign.yaml_text import check_size

    try:
        documents = compose_documents(source)
    except yaml.MarkedYAMLError as problem:
        if _python_reads(source.text):
            return
        mark = problem.problem_mark or problem.context_mark
        message = " ".join(part for part in (problem.context, problem.problem) if part)
        help_ = (
            "indent with spaces" if "\\t" in message else "check the indentation, quotes and brackets above this place"
        )
        begun = problem.context_mark
        place = span_at(source, mark)
        notes = (Note("what is read there begins here", span_at(source, begun)),) if begun is not None else ()
        yield RuleFinding(place, f"not valid YAML: {message}", help_, notes if notes and notes[0].span != place else ())
    except yaml.YAMLError as problem:
        yield RuleFinding(Span(source, 0, 1), f"not valid YAML: {str(problem).splitlines()[0]}")
    else:
        try:
            for document in documents:
                check_size(document, MAX_VALUES)
        except yaml.MarkedYAMLError as problem:
            place = span_at(source, problem.problem_mark)
            help_ = "write less, above all less aliases (*name), which multiply"
            yield RuleFinding(place, f"not valid YAML: {problem.problem}", help_)


def _python_reads(text: str) -> bool:
    # roslaunch uses the parser in Python, which accepts a little more than libyaml, and is ten times as slow.
    import yaml

    try:
        list(yaml.compose_all(text, Loader=yaml.SafeLoader))
    except (yaml.YAMLError, RecursionError):
        return False
    return True


def _find_duplicate_keys(view: YamlView) -> Iterable[RuleFinding]:
    if not is_plain_yaml(view.source):
        return
    import yaml

    try:
        documents = compose_documents(view.source)
    except yaml.YAMLError:
        return  # bad-yaml speaks of it
    for mapping in (mapping for document in documents for mapping in mappings_in(document)):
        first: dict[str, yaml.Node] = {}
        for key, value in mapping.value:
            if not isinstance(key, yaml.ScalarNode) or key.value == "<<" or _is_section(value):
                continue
            name = str(key.value)
            if name in first:
                place = span_at(view.source, first[name].start_mark, first[name].end_mark)
                yield RuleFinding(
                    span_at(view.source, key.start_mark, key.end_mark),
                    f"key '{name}' is given twice, expected once: only the last value counts",
                    "remove one of the two",
                    (Note(f"the first '{name}' is here", place),),
                )
            first.setdefault(name, key)


def _is_section(value: yaml.Node) -> bool:
    # The sections of a node in a parameter file of ROS 2 add up.
    import yaml

    return isinstance(value, yaml.MappingNode) and any(key.value == "ros__parameters" for key, _ in value.value)


_YAML_RULES = (
    Rule(
        id="bad-yaml",
        group=RuleGroup.YAML,
        severity=Severity.ERROR,
        summary="A text is not valid YAML.",
        explanation="""
YAML files of the package, and YAML inside `<rosparam>`. Files that are templates (`{{`, `{%`), and OpenCV's own format,
are left alone.
""",
        bad=(
            Example({"params/magni.yaml": "speed: [0.3, 0.5\nradius«:» 0.1\n"}),
            launch_example(make_launch("<rosparam>", "  speed: [0.3, 0.5", "«<»/rosparam>")),
        ),
        good=(Example({"params/magni.yaml": "speed: [0.3, 0.5]\nradius: 0.1\n"}),),
        yaml_file=_find_bad_yaml,
    ),
    Rule(
        id="duplicate-key",
        group=RuleGroup.YAML,
        severity=Severity.WARNING,
        summary="A mapping in YAML has the same key twice.",
        explanation="""
YAML readers take the last value without a warning, so a change of the first one has no effect. Sections of one
node in a parameter file of ROS 2 add up, and are left alone.
""",
        bad=(Example({"params/magni.yaml": "speed: 0.3\nradius: 0.1\n«speed»: 0.5\n"}),),
        good=(
            Example({"params/magni.yaml": "left: {speed: 0.3}\nright: {speed: 0.5}\n"}),
            Example({"params/a.yaml": "/**:\n  ros__parameters: {a: 1}\n/**:\n  ros__parameters: {b: 2}\n"}),
        ),
        yaml_file=_find_duplicate_keys,
    ),
)


def compose_documents(source: SourceFile) -> list[yaml.Node]:
    """Return the documents of a text. Raises yaml.YAMLError."""
    import yaml

    from ur.source.foreign.yaml_text import LOADER, check_depth

    check_depth(source.text)
    return [node for node in yaml.compose_all(source.text, Loader=LOADER) if node is not None]


def is_plain_yaml(source: SourceFile) -> bool:
    """Return whether a text should be plain YAML: not a template, and not OpenCV's own format."""
    return not source.text.startswith("%YAML:") and "{{" not in source.text and "{%" not in source.text


def span_at(source: SourceFile, mark: yaml.Mark | None, end: yaml.Mark | None = None) -> Span:
    """Return the position of a mark of PyYAML; up to the mark `end` if that is on the same line."""
    if mark is None:
        return Span(source, 0, min(1, len(source.text)))
    start = _offset(source, mark)
    if end is not None and end.line == mark.line:
        return Span(source, start, _offset(source, end))
    return Span(source, start, min(start + 1, len(source.text)))


def mappings_in(top: yaml.Node) -> Iterator[yaml.MappingNode]:
    """Yield every mapping in a tree once."""
    import yaml

    stack, seen = [top], {id(top)}
    while stack:
        node = stack.pop()
        inner: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            yield node
            inner = [part for pair in node.value for part in pair]
        elif isinstance(node, yaml.SequenceNode):
            inner = list(node.value)
        for part in inner:
            if id(part) not in seen:
                seen.add(id(part))
                stack.append(part)


def _offset(source: SourceFile, mark: yaml.Mark) -> int:
    # libyaml counts bytes in `index` but characters in `column`; lines are safe in both.
    offset = 0
    for _ in range(mark.line):
        offset = source.text.find("\n", offset) + 1
    return int(min(offset + mark.column, len(source.text)))


RULES = (
    *_YAML_RULES,
    Rule(
        id="broken-package",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A package.xml on the package path cannot be read.",
        explanation="""
rospack reads every `package.xml` on ROS_PACKAGE_PATH; one that is broken keeps roslaunch from finding any package.
Repair or remove the file that the message names.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="deprecated-file",
        group=RuleGroup.FILES,
        severity=Severity.WARNING,
        summary="A file says of itself that it is deprecated.",
        explanation="""
`<launch deprecated='why'>` makes roslaunch print the reason. Include the file that it names instead.
""",
        bad=launch_examples("""
<launch deprecated="«use talk.launch»">
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
"""),
        good=launch_examples(make_launch('<node name="talker" pkg="demo_nodes" type="talker"/>')),
    ),
    Rule(
        id="include-cycle",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A file includes itself, directly or through others.",
        explanation="""
roslaunch goes on until Python gives up. A condition that becomes false ends the circle.
""",
        bad=launch_examples(make_launch('<include file="«$(find my_robot)/launch/example.launch»"/>')),
        good=launch_examples("""
<launch>
  <arg name="again" default="true"/>
  <include file="$(find my_robot)/launch/example.launch" if="$(arg again)">
    <arg name="again" value="false"/>
  </include>
</launch>
"""),
    ),
    Rule(
        id="include-too-deep",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="Files are included 200 levels deep.",
        explanation="""
200 levels are more than anybody can follow. The limit keeps `ur` from hanging.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="too-many-includes",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="More than 20,000 files are included.",
        explanation="""
Files that include others twice each double their number with every level. The limit keeps `ur` from hanging.
""",
        bad=(),
        good=(),
    ),
    Rule(
        id="unreadable-file",
        group=RuleGroup.FILES,
        severity=Severity.ERROR,
        summary="A file cannot be read as text.",
        explanation="""
Launch files, YAML files and programs are UTF-8 texts. The message says whether permission or an encoding is the reason.
""",
        bad=(),
        good=(),
    ),
)
