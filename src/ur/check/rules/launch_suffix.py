"""A launch file's ending does not say what it is for."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.example_parts import MARKED_LAUNCH, SUMMARY, make_launch, make_talk_launch
from ur.check.house import file_name, house_folder
from ur.check.model import Example, Found, Group, PackageView, Rule
from ur.source.diagnostic import Note, Severity


def _find_wrong_suffix(view: PackageView) -> Iterable[Found]:
    for launch_view in view.launch_files:
        launch, name = launch_view.tree.launch, file_name(launch_view)
        if launch is None or house_folder(launch_view) is None or name.endswith(".launch.xml"):
            continue
        if not name.endswith(".launch"):
            yield Found(
                launch.span, f"{name} holds a <launch>, expected the ending .launch or .launch.xml", "rename it"
            )
        elif launch_view.path in view.included:
            place = view.included[launch_view.path][0]
            yield Found(
                launch.span,
                f"{name} is included by another file, expected the ending .launch.xml",
                f"rename it to {name}.xml: .launch is for files that people start",
                (Note("it is included here", place),),
            )


def _example(suffix: str, part: str) -> Example:
    included = f"n_talker/launch/n_talker.{suffix}"
    whole = make_launch(
        SUMMARY, "<!--Overview: Includes what says it.-->", f'<include file="$(find my_robot)/{included}"/>'
    )
    return Example({"m_talk/launch/m_talk.launch": whole, included: part})


RULE = Rule(
    id="launch-suffix",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A launch file's ending does not say what it is for.",
    explanation="""
`.launch` files are started by people and complete with Tab; `.launch.xml` files are included by others.
""",
    bad=(_example("launch", make_talk_launch(tag=MARKED_LAUNCH)),),
    good=(_example("launch.xml", make_talk_launch()),),
    house=True,
    whole_package=_find_wrong_suffix,
)
