"""An argument is declared and nothing uses it."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.model import Found, Group, LaunchView, Rule, launch_example
from ur.check.survey import walk_elements
from ur.source.diagnostic import Severity
from ur.source.suggest import did_you_mean


def _find_unused(view: LaunchView) -> Iterable[Found]:
    if _uses_all(view):
        return
    for name, elements in view.declared.items():
        # Where a name near to it is used and not declared, that one is misspelt, and reported.
        if "$(" not in name and name not in view.used and not did_you_mean(name, set(view.used) - set(view.declared)):
            message = f"argument '{name}' is declared and not used, expected a place that uses it"
            help_ = "remove it, or use it where it was meant to be"
            yield Found(elements[0].value_span("name"), message, help_, subject=name)


def _uses_all(view: LaunchView) -> bool:
    # Included files and YAML files may use what is declared here.
    for element, _ in walk_elements(view.tree.launch):
        if element.attributes.get("pass_all_args", "false").lower() != "false":
            return True
        if "file" in element.attributes and element.attributes.get("subst_value", "false").lower() != "false":
            return True
    return False


RULE = Rule(
    id="unused-argument",
    group=Group.ARGUMENTS,
    severity=Severity.WARNING,
    summary="An argument is declared and nothing uses it.",
    explanation="""
Whoever gives the argument expects it to have an effect. It is a warning because the file works. Files that hand on
everything with `pass_all_args`, or into YAML with `subst_value`, are left alone, and so are arguments that another file
passes: roslaunch refuses a file that does not declare what it is passed.
""",
    bad=(
        launch_example("""
<launch>
  <arg name="«speed»" default="0.3"/>
  <param name="limit" value="0.5"/>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="speed" default="0.3"/>
  <arg name="fast" value="$(eval speed > 1)"/>
  <rosparam subst_value="true">
    speeds: [$(arg speed), $(arg fast)]
  </rosparam>
</launch>
"""),
    ),
    launch_file=_find_unused,
)
