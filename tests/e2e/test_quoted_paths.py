"""Worlds, maps and a library below a folder with an apostrophe and a blank in its name, under `ur` and roslaunch."""

import shutil
import subprocess
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, make_environment

pytestmark = [pytest.mark.ros, pytest.mark.timeout(600)]

LIBRARY = ROOT / "ubiquity_launches"
HOSTILE = "lab' sh -c 'touch PWN' '.yaml"  # in a quotation of a launch-prefix, it would run a command


def make_lab(folder: Path) -> tuple[Path, dict[str, str]]:
    """Return a folder `o'brien lab` with a world of a hostile name, and an environment with a display and an RViz.

    That RViz is in a catkin workspace, so it is started in place of the one that Debian may have installed.
    """
    lab = folder / "o'brien lab"
    lab.mkdir()
    maps = LIBRARY / "n_map_server" / "maps"
    shutil.copy(maps / "maze.png", lab)
    shutil.copy(maps / "maze.yaml", lab / HOSTILE)
    share, lib = folder / "stub" / "share" / "rviz", folder / "stub" / "lib" / "rviz"
    share.mkdir(parents=True)
    lib.mkdir(parents=True)
    (folder / "stub" / ".catkin").touch()
    (share / "package.xml").write_text("<package><name>rviz</name></package>", encoding="utf-8")
    (lib / "rviz").write_text('#!/bin/sh\nprintf "%s\\n" "$@" >"$HOME/rviz.started"\nexec sleep 300\n')
    (lib / "rviz").chmod(0o755)
    env = make_environment(folder)
    env["ROS_PACKAGE_PATH"] = f"{share.parent}:{env['ROS_PACKAGE_PATH']}"
    return lab, env | {"DISPLAY": ":97", "CMAKE_PREFIX_PATH": str(folder / "stub")}


def run(lab: Path, env: dict[str, str], *command: str) -> str:
    done = subprocess.run(
        command, env=env, input="g 1 0 0\n", capture_output=True, text=True, timeout=150, cwd=lab, check=False
    )
    output = done.stdout + done.stderr
    assert "g 1 0 0: reached, " in done.stdout, output
    assert "Traceback" not in output
    assert not [*lab.parent.rglob("PWN")]
    return output


def read_rviz(env: dict[str, str]) -> list[str]:
    return Path(env["HOME"], "rviz.started").read_text(encoding="utf-8").splitlines()


def test_robot_navigates_in_a_world_whose_name_would_be_a_command(tmp_path: Path) -> None:
    lab, env = make_lab(tmp_path)
    run(lab, env, str(ROOT / "ur"), "run", "keyboard_navigate", "robot_base:=stage", f"world:=./{HOSTILE}")
    # The view of the configuration is fitted to the map, so the map's path arrived whole.
    assert read_rviz(env)[:2] == ["-d", str(tmp_path / "home" / ".ros" / "rviz" / "navigation.rviz")]


def test_roslaunch_starts_a_library_below_a_folder_with_an_apostrophe(tmp_path: Path) -> None:
    lab, env = make_lab(tmp_path)
    library = lab / "ubiquity_launches"
    shutil.copytree(LIBRARY, library, symlinks=True)
    (library / "lib" / "repository").write_text(f"{ROOT}\n", encoding="utf-8")
    env["ROS_PACKAGE_PATH"] = f"{library}:{tmp_path / 'stub' / 'share'}:/usr/share"
    words = ("robot_base:=stage", f"world:={lab / HOSTILE}", f"map_file:={lab / HOSTILE}")
    run(lab, env, "roslaunch", "ubiquity_launches", "m_keyboard_navigate.launch.xml", *words)
    assert read_rviz(env)[:2] == ["-d", str(tmp_path / "home" / ".ros" / "rviz" / "navigation.rviz")]
