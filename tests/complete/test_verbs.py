"""What is offered where."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from ur.cli.verbs import VERBS
from ur.complete.completions import Completion, NameSources, Option
from ur.complete.line import split_line
from ur.complete.verbs import complete_line
from ur.launchfile.world.system import SystemWorld

LAUNCH = """<launch>
  <arg name="robot_base"/>
  <!--robot_base: The `base`.-->
  <arg name="speed" default="$(arg robot_base)_1"/>
  <!--speed: How fast.-->
  <arg name="loud" default="false"/>
  <arg name="fixed" value="1"/>
</launch>
"""


@pytest.fixture
def world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SystemWorld:
    package = tmp_path / "my_robot"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>")
    (package / "launch" / "drive.launch").write_text(LAUNCH)
    (package / "launch" / "part.launch.xml").write_text(LAUNCH)
    (tmp_path / "here.launch").write_text(LAUNCH)
    (tmp_path / "notes.txt").write_text("")
    monkeypatch.chdir(tmp_path)
    return SystemWorld({"ROS_PACKAGE_PATH": str(tmp_path)})


def values(name: str, given: Mapping[str, str]) -> list[Completion]:
    return [Completion("stage"), Completion("magni")] if name == "robot_base" and "machine" not in given else []


def offer(line: str, world: SystemWorld) -> list[str]:
    options = [
        Option(("--only",), "one node", takes_value=True),
        Option(("-v", "--verbose"), "more"),
        Option(("--form",), "which", takes_value=True, choices=("json", "text")),
        Option(("--robot",), "whose", takes_value=True),
        Option(("--select",), "rules", takes_value=True),
    ]
    known = NameSources(
        {
            "verb": lambda: [Completion("launch"), Completion("logs"), Completion("run")],
            "program": lambda: [Completion("drive"), Completion("dance")],
            "robot": lambda: [Completion("loki")],
            "rule": lambda: [Completion("bad-name"), Completion("bad-yaml"), Completion("unknown-tag")],
        },
        lambda verb: ("help topic",) if verb == "help" else VERBS[verb].arguments if verb in VERBS else (),
        lambda _verb: options,
        lambda name: "my_robot/launch/drive.launch" if name == "drive" else None,
        values,
        lambda _path, _words: [Completion("talker"), Completion("/talker")],
    )
    return [each.text for each in complete_line(split_line(line), world, known)]


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("ur l", ["launch", "logs"]),
        ("ur launch my", ["my_robot", "my_robot/"]),
        ("ur launch ./", ["./here.launch", "./my_robot/"]),
        ("ur launch my_robot/launch/", ["my_robot/launch/drive.launch"]),
        ("ur launch my_robot/launch/part.launch.", ["my_robot/launch/part.launch.xml"]),
        ("ur launch my_robot ", ["drive.launch"]),
        ("ur launch my_robot part", ["part.launch.xml"]),
        ("ur launch my_robot/launch/p", ["my_robot/launch/part.launch.xml"]),
        ("ur launch my_robot part.launch.", ["part.launch.xml"]),
        ("ur launch my_robot drive.launch ", ["robot_base:=", "speed:=", "loud:="]),
        ("ur launch here.launch s", ["speed:="]),
        ("ur launch here.launch robot_base:=x l", ["loud:="]),
        ("ur launch here.launch robot_base:=m", ["robot_base:=magni"]),
        ("ur launch here.launch loud:=", ["loud:=true", "loud:=false"]),
        ("ur launch here.launch --", ["--only", "--verbose", "--form", "--robot", "--select"]),
        ("ur launch --form ", ["json", "text"]),
        ("ur launch --form json here.launch lo", ["loud:="]),
        ("ur run d", ["drive", "dance"]),
        ("ur run drive sp", ["speed:="]),
        ("ur run dance ", []),
        ("ur check my", ["my_robot/", "my_robot"]),
        ("ur check my_robot no", ["notes.txt"]),
        ("ur check my_robot dr", ["drive.launch"]),
        ("ur check --select b", ["bad-name", "bad-yaml"]),
        ("ur check --select bad-name,b", ["bad-name,bad-name", "bad-name,bad-yaml"]),
        ("ur launch --select b", []),
        ("ur explain my_robot ", ["drive.launch"]),
        ("ur explain here.launch ta", ["talker"]),
        ("ur explain my_robot drive.launch ta", ["talker"]),
        ("ur explain here.launch robot_base:=x ta", ["talker"]),
        ("ur explain here.launch talker s", ["speed:="]),
        ("ur shell ", ["loki"]),
        ("ur shell loki ", []),
        ("ur nonsense ", []),
    ],
)
def test_offered(line: str, offered: list[str], world: SystemWorld) -> None:
    assert sorted(offer(line, world)) == sorted(offered)


def test_arguments_come_with_their_documentation(world: SystemWorld) -> None:
    found = complete_line(split_line("ur launch here.launch "), world, NameSources(kinds=lambda _verb: ("launch",)))
    assert [(each.text, each.help, each.open) for each in found][:2] == [
        ("robot_base:=", "The base. (required)", True),
        ("speed:=", "How fast. (default '..._1')", True),
    ]


def test_option_that_names_a_robot_offers_robots(world: SystemWorld) -> None:
    assert offer("ur boot install --robot ", world) == ["loki"]
