"""Reports as JSON, GitHub commands and text."""

from __future__ import annotations

import json

from ur.check.render.text import render_github, render_json, render_text, shorten_paths
from ur.check.session import CheckReport, check_paths
from ur.launchfile.world import MemoryWorld

FILES = {
    "/w/main.launch": '<launch>\n  <include file="/w/part.launch"/>\n</launch>\n',
    "/w/part.launch": '<launch>\n  <arg name="100%, all"/>\n  <param name="é" value="$(arg b)"/>\n</launch>\n',
}


def report() -> CheckReport:
    return shorten_paths(check_paths(["/w"], MemoryWorld(FILES)), "/w")


def test_json_has_places_from_one_and_counts() -> None:
    body = json.loads(render_json(report()))
    assert body["summary"] == {"files": 2, "errors": 2, "warnings": 1, "suppressed": 0}
    finding = next(each for each in body["findings"] if each["rule"] == "undeclared-argument")
    assert {key: finding[key] for key in ("path", "line", "column", "end_line", "end_column", "severity")} == {
        "path": "part.launch",
        "line": 3,
        "column": 26,
        "end_line": 3,
        "end_column": 34,
        "severity": "error",
    }
    assert [(note["path"], note["line"]) for note in finding["notes"]] == [("main.launch", 2)]


def test_github_commands_are_one_line_each_with_escapes() -> None:
    lines = render_github(report()).splitlines()
    assert len(lines) == 3
    assert lines[0].startswith("::error file=main.launch,line=2,endLine=2,title=missing-argument,col=3,endColumn=11::")
    assert "100%25, all" in lines[0]
    assert "%0Ahelp: " in lines[0]


def test_text_ends_with_counts() -> None:
    assert render_text(report()).endswith("\n2 errors and 1 warning in 2 files\n")
    assert render_text(CheckReport((), 1, 2)) == "nothing found in 1 file (2 findings hidden by comments)\n"


def test_text_names_values_that_are_not_known_in_one_line_per_file() -> None:
    lines = [f"    v{number} = subprocess.run(['{number}']).stdout" for number in range(5)]
    nodes = [f"Node(package='demo', executable=v{number})" for number in range(5)]
    head = "import subprocess\nfrom launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
    body = "\n".join((*lines, f"    return LaunchDescription([{', '.join(nodes)}])\n"))
    world = MemoryWorld({"/w/launch/a.launch.py": f"{head}def generate_launch_description():\n{body}"})
    checked = check_paths(["/w"], world)
    first, *rest = render_text(checked).splitlines()
    assert first.startswith("/w/launch/a.launch.py: note: 5 values are not known without running it: line 5: ")
    assert first.endswith("; and 2 more")
    assert rest == ["nothing found in 1 file"]
    assert [each["line"] for each in json.loads(render_json(checked))["not_known"]] == [5, 6, 7, 8, 9]
