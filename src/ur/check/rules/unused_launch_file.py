"""Nothing uses a launch file."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import MARKED_LAUNCH, PROGRAM_HEAD, make_talk_launch
from ur.check.house import file_name, house_folder
from ur.check.model import Example, Found, Group, PackageView, Rule
from ur.source.diagnostic import Severity


def _find_unused(view: PackageView) -> Iterable[Found]:
    for launch_view in view.launch_files:
        launch, name = launch_view.tree.launch, file_name(launch_view)
        if launch is None or house_folder(launch_view) is None or not name.endswith(".launch.xml"):
            continue
        started = any(name in program.source.text for program in view.programs)
        if launch_view.path not in view.included and not started:
            yield Found(
                launch.span,
                f"nothing uses {name}, expected a launch file that includes it or a program that starts it",
                f"include it, write bin/ur_..., or rename it to {name.removesuffix('.xml')}: people start those",
            )


_PATH = "n_talker/launch/n_talker.launch.xml"
_PROGRAM = PROGRAM_HEAD + 'exec roslaunch my_robot n_talker.launch.xml "$@"\n'

RULE = Rule(
    id="unused-launch-file",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="Nothing uses a launch file.",
    explanation="""
A `.launch.xml` file is there to be included, or to be started by a program in `bin`. One that nothing uses is not tried
by anybody, and soon does not work. Only looked at when the whole package is checked.
""",
    bad=(Example({_PATH: make_talk_launch(tag=MARKED_LAUNCH)}),),
    good=(Example({_PATH: make_talk_launch(), "bin/ur_talk": _PROGRAM}),),
    house=True,
    whole_package=_find_unused,
)
