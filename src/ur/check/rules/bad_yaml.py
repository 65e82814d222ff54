"""A text is not valid YAML."""

from __future__ import annotations

from collections.abc import Iterable

import yaml

from ur.check.model import Example, Found, Group, Rule, YamlView, launch_example
from ur.check.yaml_nodes import compose_documents, is_plain_yaml, span_at
from ur.source.diagnostic import Note, Severity
from ur.source.file import Span


def _find_bad_yaml(view: YamlView) -> Iterable[Found]:
    source = view.source
    if not is_plain_yaml(source):
        return
    try:
        compose_documents(source)
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
        yield Found(place, f"not valid YAML: {message}", help_, notes if notes and notes[0].span != place else ())
    except yaml.YAMLError as problem:
        yield Found(Span(source, 0, 1), f"not valid YAML: {str(problem).splitlines()[0]}")


def _python_reads(text: str) -> bool:
    # roslaunch uses the parser in Python, which accepts a little more than libyaml, and is ten times as slow.
    try:
        list(yaml.compose_all(text, Loader=yaml.SafeLoader))
    except (yaml.YAMLError, RecursionError):
        return False
    return True


RULE = Rule(
    id="bad-yaml",
    group=Group.YAML,
    severity=Severity.ERROR,
    summary="A text is not valid YAML.",
    explanation="""
YAML files of the package, and YAML inside `<rosparam>`. Files that are templates (`{{`, `{%`), and OpenCV's own format,
are left alone.
""",
    bad=(
        Example({"params/magni.yaml": "speed: [0.3, 0.5\nradius«:» 0.1\n"}),
        launch_example("""
<launch>
  <rosparam>
    speed: [0.3, 0.5
  «<»/rosparam>
</launch>
"""),
    ),
    good=(Example({"params/magni.yaml": "speed: [0.3, 0.5]\nradius: 0.1\n"}),),
    yaml_file=_find_bad_yaml,
)
