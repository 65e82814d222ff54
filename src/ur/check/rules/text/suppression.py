"""Rules about the comments that hide findings."""

from ur.check.rule import Rule, RuleGroup, TextEdit, launch_example, launch_examples
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span

_SUPPRESSED = """
<launch>
  <!--ur: ignore unused-argument: files that include this one still pass it-->
  <arg name="speed" default="0.3"/>
</launch>
"""


def _remove_comment(found: Diagnostic) -> tuple[TextEdit, ...]:
    # With its line, if nothing else is on it; only if it names a single rule.
    if found.span is None or "," in found.span.text.partition(":")[2].partition(":")[0]:
        return ()
    file, start, end = found.span
    line_start = file.text.rfind("\n", 0, start) + 1
    line_end = file.text.find("\n", end)
    if line_end != -1 and not file.text[line_start:start].strip() and not file.text[end:line_end].strip():
        return (TextEdit(Span(file, line_start, line_end + 1), ""),)
    return (TextEdit(found.span, ""),)


RULES = (
    Rule(
        id="bad-suppression",
        group=RuleGroup.COMMENTS,
        severity=Severity.WARNING,
        summary="A comment that is to hide a finding cannot be understood.",
        explanation="""
`<!--ur: ignore RULE: REASON-->` hides findings of a rule in the element that follows, `ignore-file` in the whole file.
In YAML and programs it is `# ur: ignore RULE: REASON`, at the end of a line or alone above it. Several rules are
separated by commas. The reason may not be left out.
""",
        bad=(
            launch_example("""
<launch>
  «<!--ur: ignore unused-arguments: files that include this one still pass it-->»
  <param name="speed" value="0.3"/>
</launch>
"""),
            launch_example("""
<launch>
  «<!--ur: ignore unused-argument-->»
  <param name="speed" value="0.3"/>
</launch>
"""),
        ),
        good=(launch_example(_SUPPRESSED),),
    ),
    Rule(
        id="unused-suppression",
        group=RuleGroup.COMMENTS,
        severity=Severity.WARNING,
        summary="A comment hides a finding that is not there.",
        explanation="""
What it was about is repaired, or it stands in the wrong place. `--fix` removes it. Only looked at when all rules are
checked.
""",
        bad=launch_examples("""
<launch>
  «<!--ur: ignore unused-argument: files that include this one still pass it-->»
  <arg name="speed" default="0.3"/>
  <param name="speed" value="$(arg speed)"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <!--ur: ignore unused-argument: files that include this one still pass it-->
  <arg name="speed" default="0.3"/>
</launch>
"""),
        fix=_remove_comment,
    ),
)
