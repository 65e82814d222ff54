"""A launch file has no Summary."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import MARKED_LAUNCH, OVERVIEW, TALKER, house_example, make_launch, make_talk_launch
from ur.check.house import find_heading, house_folder
from ur.check.model import Found, Group, LaunchView, Rule
from ur.source.diagnostic import Severity


def _find_missing(view: LaunchView) -> Iterable[Found]:
    launch = view.tree.launch
    if launch is not None and house_folder(view) is not None and not find_heading(view, "Summary"):
        yield Found(
            launch.span,
            "a launch file without a Summary, expected one line that says what the file does",
            "write <!--Summary: ...--> after <launch>",
        )


RULE = Rule(
    id="missing-summary",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A launch file has no Summary.",
    explanation="""
`<!--Summary: ...-->` is one line that says what the file does. Lists of launch files show it.
""",
    bad=(house_example(make_launch(OVERVIEW, TALKER, tag=MARKED_LAUNCH)),),
    good=(house_example(make_talk_launch()),),
    house=True,
    launch_file=_find_missing,
)
