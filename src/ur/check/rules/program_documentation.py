"""A program does not say what it does."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ur.check.example_parts import make_talk_launch
from ur.check.model import Example, Found, Group, ProgramView, Rule
from ur.source.diagnostic import Severity
from ur.source.file import Span

_HEADINGS = {name: re.compile(rf"^##\s*{name}:\s*\S", re.MULTILINE) for name in ("Summary", "Overview")}


def _find_undocumented(view: ProgramView) -> Iterable[Found]:
    if view.source.path.endswith("/bin/ur"):  # the command itself
        return
    missing = [name for name, pattern in _HEADINGS.items() if not pattern.search(view.source.text)]
    if missing:
        first_line = view.source.text.partition("\n")[0]
        yield Found(
            Span(view.source, 0, len(first_line)),
            f"a program without {' and '.join(missing)}, expected comments that say what it does",
            "write " + " and ".join(f"##{name}: ..." for name in missing) + " after the first line",
        )


_GOOD = """#!/bin/bash
##Summary: Say something.
##Overview: Once per second, until
## Control-C.
exec roslaunch my_robot n_talker.launch.xml "$@"
"""


def _example(program: str) -> Example:
    return Example({"bin/ur_talk": program, "n_talker/launch/n_talker.launch.xml": make_talk_launch()})


RULE = Rule(
    id="program-documentation",
    group=Group.HOUSE,
    severity=Severity.WARNING,
    summary="A program does not say what it does.",
    explanation="""
`ur list` shows the line `##Summary:` of each program in `bin`, and `ur docs` its `##Overview:`, which goes on in the
lines with `##` that follow.
""",
    bad=(_example('«#!/bin/bash»\n##Summary: Say something.\nexec roslaunch my_robot n_talker.launch.xml "$@"\n'),),
    good=(_example(_GOOD),),
    house=True,
    program=_find_undocumented,
)
