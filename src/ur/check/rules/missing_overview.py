"""A launch file has no Overview."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import MARKED_LAUNCH, SUMMARY, TALKER, house_example, make_launch, make_talk_launch
from ur.check.house import find_heading, house_folder
from ur.check.model import Found, Group, LaunchView, Rule
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
    bad=(house_example(make_launch(SUMMARY, TALKER, tag=MARKED_LAUNCH)),),
    good=(house_example(make_talk_launch()),),
    house=True,
    launch_file=_find_missing,
)
