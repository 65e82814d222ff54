"""A launch file is not named as its directory."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import MARKED_LAUNCH, house_example, make_talk_launch
from ur.check.house import file_name, house_folder
from ur.check.model import Found, Group, LaunchView, Rule
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


RULE = Rule(
    id="launch-file-name",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A launch file is not named as its directory.",
    explanation="""
A directory `n_x`, `m_x` or `rviz_x` holds one launch file of this name, so that each of the two tells the other.
""",
    bad=(house_example(make_talk_launch(tag=MARKED_LAUNCH), "talker.launch"),),
    good=(house_example(make_talk_launch()),),
    house=True,
    launch_file=_find_other_name,
)
