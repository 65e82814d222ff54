"""xacro files are expanded by the xacro of this computer; a stand-in for it shows how its ends are reported."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ur.robot.description.xacro import read_description
from ur.source.diagnostic import UserError

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="other.xacro"/></robot>'


@pytest.fixture(autouse=True)
def only_on_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [])  # not as a library


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "robot.urdf"
    path.write_text(XACRO, encoding="utf-8")
    return path


def make_xacro(tmp_path: Path, script: str) -> dict[str, str]:
    program = tmp_path / "xacro"
    program.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    program.chmod(0o755)
    return {"PATH": f"{tmp_path}:/usr/bin:/bin"}


def test_plain_urdf_needs_no_xacro(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text("<robot/>", encoding="utf-8")
    assert read_description(path, {"PATH": ""}, dict).text == "<robot/>"


def test_file_that_uses_xacro_is_expanded_whatever_its_suffix(tmp_path: Path, file: Path) -> None:
    environment = make_xacro(tmp_path, "echo \"<robot name='$1'/>\"")
    assert read_description(file, environment, dict).text == f"<robot name='{file}'/>\n"


def test_xacro_gets_the_folders_of_packages(tmp_path: Path, file: Path) -> None:
    assert read_description(file, make_xacro(tmp_path, "cat"), lambda: {"p": "/there"}).text == '{"p": "/there"}'


def test_xacro_gets_its_arguments_and_a_plain_file_takes_none(tmp_path: Path, file: Path) -> None:
    environment = make_xacro(tmp_path, 'echo "$2"')
    assert read_description(file, environment, dict, ["colour:=red"]).text == "colour:=red\n"
    plain = tmp_path / "plain.urdf"
    plain.write_text("<robot/>", encoding="utf-8")
    with pytest.raises(UserError, match="is no xacro file, which takes no argument 'colour:=red'"):
        read_description(plain, environment, dict, ["colour:=red"])


def test_argument_without_a_default_is_asked_for(tmp_path: Path, file: Path) -> None:
    environment = make_xacro(tmp_path, "echo 'error: Undefined substitution argument colour' >&2; exit 2")
    with pytest.raises(UserError) as caught:
        read_description(file, environment, dict)
    assert caught.value.diagnostics[0].help == "its argument has no default: add colour:=VALUE to the command"
    with pytest.raises(UserError) as caught:
        read_description(file, environment, dict, ["colour:=red"])
    assert "no default" not in str(caught.value.diagnostics[0].help)


def test_missing_xacro_is_named_with_what_to_do(file: Path) -> None:
    with pytest.raises(UserError, match="there is no xacro on this computer") as caught:
        read_description(file, {"PATH": "/nowhere"}, dict)
    assert "ur get xacro" in str(caught.value.diagnostics[0].help)


def test_failure_of_xacro_is_reported_with_its_reason(tmp_path: Path, file: Path) -> None:
    environment = make_xacro(tmp_path, "printf '\\033[31mNo such file: other.xacro\\033[0m\\n' >&2; exit 2")
    with pytest.raises(UserError) as caught:
        read_description(file, environment, dict)
    assert str(caught.value) == f"xacro cannot expand '{file}': No such file: other.xacro"


STAND_IN = """\
import sys
from . import substitution_args
def get_include_files(spec, symbols):
    yield substitution_args._eval_find(spec) + "/part"
def main():
    from xacro import get_include_files
    parts = [part for name in ("here", "gone") for part in get_include_files(name, None)]
    if "bad" in sys.argv[1]:
        sys.exit("unknown macro")
    print("<robot>", *parts, "</robot>")
"""


@pytest.fixture
def made_package(tmp_path: Path) -> dict[str, str]:
    library = tmp_path / "xacro/lib/xacro"
    library.mkdir(parents=True)
    (library / "__init__.py").write_text(STAND_IN, encoding="utf-8")
    (library / "substitution_args.py").write_text("_eval_find = None\n", encoding="utf-8")
    return {"xacro": str(tmp_path / "xacro"), "here": "/here"}


def test_files_of_a_package_that_is_not_here_are_left_out_and_named(file: Path, made_package: dict[str, str]) -> None:
    read = read_description(file, {"PATH": "/nowhere"}, lambda: made_package)
    assert (read.text, read.missing) == ("<robot> /here/part </robot>\n", ("gone",))


def test_failure_after_that_names_the_packages_to_get(tmp_path: Path, made_package: dict[str, str]) -> None:
    path = tmp_path / "bad.xacro"
    path.write_text(XACRO, encoding="utf-8")
    with pytest.raises(UserError, match="unknown macro") as caught:
        read_description(path, {"PATH": "/nowhere"}, lambda: made_package)
    assert str(caught.value.diagnostics[0].help).startswith("ur get gone")
