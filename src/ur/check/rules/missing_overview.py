"""A launch file has no Overview."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.house import find_heading, house_folder
from ur.check.model import Found, Group, LaunchView, Rule, launch_example
from ur.source.diagnostic import Severity


def _find_missing(view: LaunchView) -> Iterable[Found]:
    launch = view.tree.launch
    if launch is not None and house_folder(view) is not None and not find_heading(view, "Overview"):
        yield Found(
            launch.span,
            "a launch file without an Overview, expected a few sentences, in Markdown, on how the file is used",
            "write <!--Overview: ...--> after <launch>",
        )


RULE = Rule(
    id="missing-overview",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A launch file has no Overview.",
    explanation="""
`<!--Overview: ...-->` is a few sentences, in Markdown, on how the file is used. The generated pages begin with it.
""",
    bad=(
        launch_example(
            """
«<launch»>
  <!--Summary: Say something.-->
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
""",
            name="n_talker/launch/n_talker.launch",
        ),
    ),
    good=(
        launch_example(
            """
<launch>
  <!--Summary: Say something.-->
  <!--Overview: Once per second.-->
  <node name="talker" pkg="demo_nodes" type="talker"/>
</launch>
""",
            name="n_talker/launch/n_talker.launch",
        ),
    ),
    house=True,
    launch_file=_find_missing,
)
