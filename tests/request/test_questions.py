"""The answers of `ur launch` beside those of the installed roslaunch, both as commands."""

import io
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.forking import add_rosversion, python_of_ros, run_ur

from ur.cli.main import main

ROSLAUNCH = Path("/usr/bin/roslaunch")
SOURCE = str(Path(__file__).parents[2] / "src")
FILE = """<launch>
  <arg name="port"/>
  <arg name="speed" default="$(optenv NO_SUCH 1)" doc="metres per second"/>
  <arg name="fixed" value="1"/>
  <machine name="near" address="localhost"/>
  <env name="TWO_WORDS" value="x y"/>
  <param name="printed" command="echo -n 3.5"/>
  <rosparam>b: {c: [1, two, true, 2.0]}</rosparam>
  <include file="$(dirname)/part.launch.xml"/>
  <group ns="g">
    <remap from="a" to="/b"/>
    <node pkg="nodes" type="one" name="first" args="--x 'a b' $(arg port) &quot;&quot;" launch-prefix="nice -n 1"/>
    <node pkg="nodes" type="one" name="second" machine="near"><env name="HOME" value="/elsewhere"/></node>
  </group>
  <node pkg="nodes" type="one" name="third" machine="no_such_machine"/>
  <test pkg="nodes" type="one" test-name="tested" args="1"/>
</launch>
"""


Roslaunch = Callable[..., str]


@pytest.fixture
def roslaunch() -> Roslaunch:
    """The installed roslaunch: what it prints for arguments in a folder."""
    if not ROSLAUNCH.exists():
        pytest.skip("python3-roslaunch is not installed")

    def answer(words: list[str], folder: Path, **more: str) -> str:
        environment = {**_environment(folder), **more}
        done = python_of_ros().run(str(ROSLAUNCH), *words, folder=folder, environment=environment)
        assert done.returncode == 0, done.stderr
        return done.stdout.decode()

    return answer


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "nodes").mkdir()
    (tmp_path / "nodes/package.xml").write_text("<package><name>nodes</name></package>")
    (tmp_path / "nodes/one").write_text("#!/bin/sh\nenv\nprintf '<%s>' \"$@\"; echo\n")
    (tmp_path / "nodes/one").chmod(0o755)
    (tmp_path / "a.launch").write_text(FILE)
    (tmp_path / "part.launch.xml").write_text('<launch><node pkg="nodes" type="one" name="inner"/></launch>')
    return tmp_path


def _environment(folder: Path) -> dict[str, str]:
    own = dict.fromkeys(("HOME", "ROS_HOME", "ROS_LOG_DIR", "ROS_PACKAGE_PATH"), str(folder))
    return {"PATH": add_rosversion(folder), "LC_ALL": "C.UTF-8", "PYTHONPATH": SOURCE, **own}


def _run(words: list[str], folder: Path, stdin: str = "", **more: str) -> subprocess.CompletedProcess[str]:
    environment = {**_environment(folder), **more}
    return subprocess.run(words, capture_output=True, text=True, timeout=60, env=environment, input=stdin, check=False)


def _ur(words: list[str], folder: Path, stdin: str = "", **more: str) -> subprocess.CompletedProcess[str]:
    environment = {**_environment(folder), **more}
    return run_ur("launch", *words, folder=Path.cwd(), environment=environment, given=stdin)


@pytest.mark.parametrize(
    "words",
    [
        ["--nodes"],
        ["--dump-params"],
        ["--ros-args"],
        ["--find-node", "/g/first"],
        ["--find-node", "inner"],
        ["--args", "/g/first"],
        ["--args", "g/second"],
        ["--args", "third"],
        ["--args", "/tested"],
    ],
    ids=" ".join,
)
def test_answers_are_those_of_roslaunch(words: list[str], folder: Path, roslaunch: Roslaunch) -> None:
    asked = [*words, str(folder / "a.launch"), "port:=7"]
    assert _ur(asked, folder).stdout == roslaunch(asked, folder)


def test_args_name_only_variables_that_differ(folder: Path, roslaunch: Roslaunch) -> None:
    asked = ["--args", "g/first", str(folder / "a.launch"), "port:=7"]
    more = {"ROS_NAMESPACE": "/g", "TWO_WORDS": "x y", "ROS_MASTER_URI": "http://robot:11311"}
    ours, theirs = _ur(asked, folder, **more).stdout, roslaunch(asked, folder, **more)
    # In ROS_NAMESPACE /g the node is /g/g/first; roslaunch resolves what is asked for in it, too.
    assert ours == theirs


def test_files_are_those_of_roslaunch(folder: Path, roslaunch: Roslaunch) -> None:
    asked = ["--files", str(folder / "a.launch"), "port:=7"]
    theirs = roslaunch(asked, folder).splitlines()
    assert _ur(asked, folder).stdout.splitlines() == sorted(theirs)


def test_dump_holds_everything_and_sorts_its_keys(folder: Path) -> None:
    path = str(folder / "a.launch")
    (folder / "a.launch").write_text(FILE.replace("no_such_machine", "near"))
    done = _ur(["--dump", "json", path, "port:=7"], folder)
    dumped = json.loads(done.stdout)
    assert (done.returncode, done.stderr) == (0, "")
    assert set(dumped) == {"ok", "nodes", "tests", "params", "clear_params", "machines", "files"}
    assert json.dumps(dumped, sort_keys=True, indent=2) + "\n" == done.stdout
    assert [node["name"] for node in dumped["nodes"]] == ["/g/first", "/g/second", "/inner", "/third"]
    assert set(dumped["nodes"][0]) == {
        *("name", "package", "type", "args", "machine", "respawn", "respawn_delay", "required", "output", "cwd"),
        *("launch_prefix", "remaps", "env"),
    }
    assert set(dumped["tests"][0]) - set(dumped["nodes"][0]) == {"test_name", "time_limit", "retry"}
    assert dumped["params"] == {"/printed": 3.5, "/b/c": [1, "two", True, 2.0]}
    assert dumped["files"] == [path, str(folder / "part.launch.xml")]


def test_dump_with_origins_names_places_and_includes(folder: Path) -> None:
    (folder / "a.launch").write_text(FILE.replace("no_such_machine", "near"))
    done = _ur(["--dump", "json", "--with-origins", str(folder / "a.launch"), "port:=7"], folder)
    origin = json.loads(done.stdout)["origins"]["nodes//inner"]
    assert (origin["file"], origin["line"], origin["column"]) == (str(folder / "part.launch.xml"), 1, 9)
    assert [(step["file"], step["line"]) for step in origin["includes"]] == [(str(folder / "a.launch"), 9)]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["{folder}/a.launch", "port:=7"], "machine 'no_such_machine' is not defined"),
        (["{folder}/a.launch"], "argument 'port' is required and was not given"),
        (["{folder}/none.launch"], "expected a launch file"),
        (["--no-commands", "{folder}/part.launch.xml", "{folder}/command.launch"], "programs are not run here"),
    ],
)
def test_dump_of_what_roslaunch_refuses_says_why(words: list[str], told: str, folder: Path) -> None:
    (folder / "command.launch").write_text('<launch><param name="p" command="touch made"/></launch>')
    done = _ur(["--dump", "json", *(word.format(folder=folder) for word in words)], folder)
    dumped = json.loads(done.stdout)
    assert (done.returncode, dumped["ok"]) == (1, False)
    assert told in dumped["error"]
    assert any(told in found["message"] and found["severity"] == "error" for found in dumped["diagnostics"])


def test_dump_takes_nothing_from_the_selection(folder: Path) -> None:
    (folder / "b.launch").write_text(
        '<launch><arg name="robot_base" default="d"/><param name="x" value="$(arg robot_base)"/></launch>'
    )
    done = _ur(["--dump", "json", str(folder / "b.launch")], folder)
    assert json.loads(done.stdout)["params"] == {"/x": "d"}


@pytest.mark.parametrize("option", ["--nodes", "--dump"])
def test_standard_input_is_a_launch_file(option: str, folder: Path) -> None:
    words = [option, *(["json"] if option == "--dump" else []), "-", "port:=7"]
    text = FILE.replace("no_such_machine", "near").replace("$(dirname)", str(folder))
    done = _ur(words, folder, stdin=text)
    if option == "--nodes":
        assert done.stdout == "/inner\n/g/first\n/g/second\n/third\n/tested\n"
    else:
        assert json.loads(done.stdout)["files"] == [str(folder / "part.launch.xml")]


def test_dry_run_lines_work_when_they_are_pasted(folder: Path) -> None:
    printed = _ur(["--dry-run", str(folder / "a.launch"), "port:=7"], folder)
    assert "machine 'no_such_machine' is not defined" in printed.stderr
    (folder / "a.launch").write_text(FILE.replace("no_such_machine", "near"))
    printed = _ur(["--dry-run", str(folder / "a.launch"), "port:=7"], folder)
    assert printed.returncode == 0, printed.stderr
    assert "# /g/first on this computer\n" in printed.stdout
    assert "# /g/second on machine 'near', this computer\n" in printed.stdout
    ran = _run(["bash", "-e"], folder, stdin=printed.stdout)
    first, _, rest = ran.stdout.partition("<__name:=first>")
    assert "<--x><a b><7><><a:=/b>" in first.rsplit("\n", 1)[-1]
    assert "\nROS_NAMESPACE=/g\n" in first
    assert "\nTWO_WORDS=x y\n" in first
    assert f"\nPWD={folder}\n" in first
    assert "\nHOME=/elsewhere\n" in rest.partition("<__name:=second>")[0]
    assert ran.stdout.count("<__name:=") == 4


def test_dry_run_reaches_another_computer_through_ssh(folder: Path) -> None:
    (folder / "a.launch").write_text(
        '<launch><machine name="far" address="10.0.0.9" user="bob" ssh-port="2222" env-loader="/opt/env.sh"/>'
        '<node pkg="p" type="t" name="n" ns="g" machine="far" args="\'a b\'"/></launch>'
    )
    printed = _ur(["--dry-run", str(folder / "a.launch")], folder, ROS_MASTER_URI="http://here:11311").stdout
    assert printed.splitlines()[0] == "# /g/n on machine 'far', bob@10.0.0.9"
    (folder / "ssh").write_text("#!/bin/sh\nprintf '%s\\n' \"$@\"\n")
    (folder / "ssh").chmod(0o755)
    ran = _run(["bash"], folder, stdin=printed, PATH=f"{folder}:/usr/bin:/bin")
    there = "/opt/env.sh env ROS_MASTER_URI=http://here:11311 ROS_NAMESPACE=/g rosrun p t 'a b' __name:=n"
    assert ran.stdout.splitlines() == ["-t", "-p", "2222", "--", "bob@10.0.0.9", there]


def test_dry_run_names_programs_that_are_missing(folder: Path) -> None:
    (folder / "a.launch").write_text('<launch><node pkg="nodes" type="onne" name="n"/></launch>')
    done = _ur(["--dry-run", str(folder / "a.launch")], folder)
    assert done.returncode == 1
    assert "has no executable 'onne'" in done.stderr


def test_anonymous_node_can_be_asked_for_as_it_is_written(folder: Path) -> None:
    (folder / "a.launch").write_text(
        '<launch><node pkg="nodes" type="one" name="$(anon it)" args="$(anon it) $(anon that)"/></launch>'
    )
    done = _ur(["--args", "$(anon it)", str(folder / "a.launch")], folder)
    it, that, named = done.stdout.split()[-3:]
    assert it.startswith("it_")
    assert that.startswith("that_")
    assert named == f"__name:={it}"


def test_origins_without_dump_are_refused(capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert main(["launch", "--with-origins", "x.launch"]) == 2
    assert "belong to --dump json" in capsys.readouterr().err
