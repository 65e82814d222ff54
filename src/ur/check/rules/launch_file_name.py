"""A launch file is not named as its directory."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.house import file_name, house_folder
from ur.check.model import Found, Group, LaunchView, Rule, launch_example
from ur.source.diagnostic import Severity

_SUFFIXES = (".launch.xml", ".launch")


def _find_other_name(view: LaunchView) -> Iterable[Found]:
    folder, name = house_folder(view), file_name(view)
    if folder is None or view.tree.launch is None or not name.endswith(_SUFFIXES):
        return
    suffix = next(suffix for suffix in _SUFFIXES if name.endswith(suffix))
    if name != folder + suffix:
        yield Found(
            view.tree.launch.span,
            f"the file is named {name}, expected {folder}{suffix} in {folder}/launch",
            f"rename it, or move it into a directory {name.removesuffix(suffix)}",
        )


_TEXT = """
<launch>
  <!--Summary: Say something.-->
  <!--Overview: Once per second.-->
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
"""

RULE = Rule(
    id="launch-file-name",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A launch file is not named as its directory.",
    explanation="""
A directory `n_x`, `m_x` or `rviz_x` holds one launch file of this name, so that each of the two tells the other.
""",
    bad=(launch_example(_TEXT.replace("<launch>", "«<launch»>"), name="n_talker/launch/talker.launch"),),
    good=(launch_example(_TEXT, name="n_talker/launch/n_talker.launch"),),
    house=True,
    launch_file=_find_other_name,
)
