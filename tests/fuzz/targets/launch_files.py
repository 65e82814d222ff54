"""Launch files: the plan and what is shown of it, the whole check, the layout."""

import os
from contextlib import suppress
from pathlib import Path

from tests.fuzz.target import Target
from tests.launchfile.fuzz.survive import CORPUS, WORDS, check_survives, read_corpus

from ur.check.render.text import render_text
from ur.check.session import check_paths
from ur.launchfile.world.system import SystemWorld
from ur.source.diagnostic import UserError
from ur.tools.format.run import format_file

_ENVIRONMENT = {"PATH": os.defpath, "HOME": "/home/robot", "ROS_PACKAGE_PATH": str(CORPUS), "LC_ALL": "C.UTF-8"}


def _load(data: bytes, folder: Path) -> None:
    check_survives(_write(data, folder), _ENVIRONMENT)


def _check(data: bytes, folder: Path) -> None:
    path = _write(data, folder)
    world = SystemWorld(_ENVIRONMENT)
    render_text(check_paths([str(path)], world))
    with suppress(UserError):
        format_file(str(path), data, world)


def _check_package(data: bytes, folder: Path) -> None:
    package = folder / "fuzzed"
    (package / "launch").mkdir(parents=True)
    (package / "params").mkdir()
    (package / "package.xml").write_text("<package><name>fuzzed</name></package>")
    (package / "params" / "a.yaml").write_bytes(data)
    (package / "launch" / "a.launch").write_text(
        '<launch><rosparam file="$(find fuzzed)/params/a.yaml"/></launch>', encoding="utf-8"
    )
    render_text(check_paths([str(package)], SystemWorld({**_ENVIRONMENT, "ROS_PACKAGE_PATH": str(folder)})))


def _make_yaml() -> list[bytes]:
    return [b"a: 1\nb: [1, 2.5, x]\nc: {d: true, e: ~}\n", b"# x\nspeed: 0.5\nframes:\n  - map\n  - odom\ntext: 'a'\n"]


def _write(data: bytes, folder: Path) -> Path:
    path = folder / "a.launch"
    path.write_bytes(data)
    return path


TARGETS = (
    Target("launch", _load, WORDS, read_corpus),
    Target("launch_check", _check, WORDS, read_corpus),
    Target(
        "parameters",
        _check_package,
        (*WORDS, b"&a ", b"*a", b"<<: *a", b"? ", b"- - ", b"deg(90)", b"rad(pi)"),
        _make_yaml,
    ),
)
