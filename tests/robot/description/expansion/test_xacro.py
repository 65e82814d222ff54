"""xacro files are expanded by the xacro of this computer, which reads the description and packages alone."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from ur.robot.description.expansion import xacro
from ur.robot.description.expansion.xacro import (
    BOUNDS,
    DescriptionText,
    ExpansionBounds,
    ExpansionComputer,
    read_description,
)
from ur.robot.description.surroundings import find_surroundings
from ur.source.diagnostic import UserError

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
genuine = pytest.mark.skipif(xacro.find_own() is None, reason="xacro is not installed: requirements/dev.lock")


def read(
    path: Path,
    *words: str,
    environment: dict[str, str] | None = None,
    packages: dict[str, str] | None = None,
    made: Path = Path("/nonexistent"),
    consent: Callable[[str], bool] = lambda _: False,
    bounds: ExpansionBounds = BOUNDS,
    has_own: Callable[[], bool] | None = None,
) -> DescriptionText:
    variables = {"PATH": "", **(environment or {})}
    computer = ExpansionComputer(variables, lambda: packages or {}, made, consent, bounds, has_own)
    return read_description(path, find_surroundings(path, variables), computer, words)


def write(path: Path, body: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"{HEAD}{body}</robot>", encoding="utf-8")
    return path


class Refusal:
    """An answer of no, which keeps the questions."""

    def __init__(self, asked: list[str]) -> None:
        self.asked = asked

    def __call__(self, what: str) -> bool:
        self.asked.append(what)
        return False


read_without_library = partial(read, has_own=lambda: False)


def make_program(folder: Path, script: str) -> dict[str, str]:
    folder.mkdir(exist_ok=True)
    program = folder / "xacro"
    program.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    program.chmod(0o755)
    return {"PATH": f"{folder}:/usr/bin:/bin"}


@pytest.mark.parametrize("text", ["<robot/>", '<robot><!-- <xacro:include filename="a"/> --></robot>'])
def test_only_files_named_xacro_are_expanded(tmp_path: Path, text: str) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    asked: list[str] = []
    assert read(path, consent=Refusal(asked)).text == text
    assert not asked
    with pytest.raises(UserError, match="is no xacro file, which takes no argument 'colour:=red'"):
        read(path, "colour:=red")


@genuine
def test_expansion_has_arguments_includes_packages_yaml_and_variables(tmp_path: Path) -> None:
    write(tmp_path / "bot/urdf/parts/wheel.xacro", '<link name="$(arg side)_wheel"/>')
    write(tmp_path / "bot/urdf/parts/lamp.xacro", '<link name="lamp_$(optenv LAMP off)_$(optenv NONE none)"/>')
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm/size.yaml").write_text("length: 0.5\nangle: !degrees 180\n", encoding="utf-8")
    path = write(
        tmp_path / "bot/urdf/bot.xacro",
        '<xacro:arg name="side" default="left"/><xacro:include filename="parts/*.xacro"/>'
        '<xacro:property name="size" value="${xacro.load_yaml(\'$(find arm)/size.yaml\')}"/>'
        '<link name="arm_${size.length * 2}_${round(size.angle, 2)}_$(eval 1 + 1)"/>'
        '<xacro:include filename="$(find gone)/urdf/gone.xacro"/>',
    )
    found = read(path, "side:=right", environment={"LAMP": "on"}, packages={"arm": str(tmp_path / "arm")})
    for name in ("right_wheel", "lamp_on_none", "arm_1.0_3.14_2"):
        assert f'<link name="{name}"/>' in found.text
    assert found.missing == ("gone",)


@genuine
def test_argument_without_a_default_is_asked_for(tmp_path: Path) -> None:
    path = write(tmp_path / "a.xacro", '<link name="$(arg colour)"/>')
    with pytest.raises(UserError) as caught:
        read(path)
    assert caught.value.diagnostics[0].help == "its argument has no default: add colour:=VALUE to the command"
    assert 'name="red"' in read(path, "colour:=red").text


@genuine
def test_failure_names_the_reason_and_the_packages_to_get(tmp_path: Path) -> None:
    path = write(tmp_path / "a.xacro", '<xacro:include filename="$(find gone)/a.xacro"/><xacro:arm/>')
    with pytest.raises(UserError, match="unknown macro name: xacro:arm") as caught:
        read(path)
    assert str(caught.value.diagnostics[0].help).startswith("ur get gone")


@genuine
@pytest.mark.parametrize(
    "name",
    ["{out}/secret.yaml", "../../out/secret.yaml", "link.yaml", ".hidden.yaml", "folder/secret.yaml", "pipe.yaml"],
)
def test_files_outside_hidden_or_special_are_not_read(tmp_path: Path, name: str) -> None:
    repository, out = tmp_path / "repository/bot", tmp_path / "out"
    out.mkdir()
    (out / "secret.yaml").write_text("token: hunter2", encoding="utf-8")
    repository.mkdir(parents=True)
    (repository / "package.xml").write_text("<package><name>bot</name></package>", encoding="utf-8")
    (repository / "link.yaml").symlink_to(out / "secret.yaml")
    (repository / "folder").symlink_to(out)
    (repository / ".hidden.yaml").write_text("token: hunter2", encoding="utf-8")
    os.mkfifo(repository / "pipe.yaml")
    path = write(repository / "a.xacro", f"<link name=\"${{xacro.load_yaml('{name.format(out=out)}')['token']}}\"/>")
    with pytest.raises(UserError, match=r"outside of|not a regular file"):
        read(path)


@genuine
def test_patterns_of_includes_find_nothing_outside(tmp_path: Path) -> None:
    write(tmp_path / "out/secret.xacro", '<link name="secret"/>')
    path = write(tmp_path / "in/a.xacro", "")
    (tmp_path / "in/folder").symlink_to(tmp_path / "out")
    for pattern in (f"{tmp_path}/out/*.xacro", "../*/secret.xacro", "../out/s*", "fold*/*.xacro", "/*/*/*"):
        write(path, f'<xacro:include filename="{pattern}"/>')
        assert "secret" not in read(path).text


@genuine
@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ('<xacro:include filename="a.xacro"/>', "recursion|too much memory"),
        ("<link name=\"${'x' * 10 ** 10}\"/>", "when evaluating expression|memory"),
        ("<link name=\"${'x' * 10 ** 8}\"/>", "the result is larger than 20,000,000 bytes"),
        ('<link name="${[0 for a in range(10**9) if a &lt; 0]}"/>', "did not finish within|without a result"),
        ("<link name=\"${[xacro.load_yaml('a.yaml') for n in range(10**6)]}\"/>", "more than 300 files"),
    ],
    ids=["includes itself", "memory", "output", "time", "questions"],
)
def test_expansion_has_limits(tmp_path: Path, body: str, reason: str) -> None:
    bounds = (
        ExpansionBounds(1)
        if "range(10**9)" in body
        else ExpansionBounds(questions=300)
        if "load_yaml" in body
        else ExpansionBounds()
    )
    (tmp_path / "a.yaml").write_text("1", encoding="utf-8")
    with pytest.raises(UserError, match=reason):
        read(write(tmp_path / "a.xacro", body), bounds=bounds)


@genuine
def test_user_is_asked_where_the_kernel_cannot_confine(tmp_path: Path) -> None:
    bounds = ExpansionBounds(seccomp="libnone.so.0")
    path = write(tmp_path / "a.xacro", '<link name="${1 + 1}"/>')
    asked: list[str] = []
    with pytest.raises(UserError, match="would run with all your rights") as caught:
        read(path, consent=Refusal(asked), bounds=bounds)
    assert "in a terminal" in str(caught.value.diagnostics[0].help)
    assert "libnone.so.0" in asked[0]
    assert str(path) in asked[0]
    assert '<link name="2"/>' in read(path, consent=lambda _: True, bounds=bounds).text


def test_program_on_the_path_runs_only_with_consent(tmp_path: Path) -> None:
    environment = make_program(tmp_path / "bin", "echo \"<robot name='$2'/>\"")
    path = write(tmp_path / "in/a.xacro", "")
    asked: list[str] = []
    with pytest.raises(UserError, match="did not expand") as caught:
        read_without_library(path, environment=environment, consent=Refusal(asked))
    assert "ur get xacro" in str(caught.value.diagnostics[0].help)
    assert f"'{tmp_path}/bin/xacro' cannot be confined" in asked[0]
    found = read_without_library(path, "colour:=red", environment=environment, consent=lambda _: True)
    assert found.text == "<robot name='colour:=red'/>\n"


def test_failure_of_the_program_is_reported_with_its_reason(tmp_path: Path) -> None:
    script = "printf '\\033[31mNo such file: other.xacro\\033[0m\\n' >&2; exit 2"
    path = write(tmp_path / "in/a.xacro", "")
    with pytest.raises(UserError) as caught:
        read_without_library(path, environment=make_program(tmp_path / "bin", script), consent=lambda _: True)
    assert str(caught.value) == f"xacro cannot expand '{path}': No such file: other.xacro"


def test_missing_xacro_is_named_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no xacro on this computer") as caught:
        read_without_library(write(tmp_path / "a.xacro", ""), environment={"PATH": "/nowhere"})
    assert "ur get xacro" in str(caught.value.diagnostics[0].help)


def test_package_that_ur_get_has_made_is_used(tmp_path: Path) -> None:
    made = tmp_path / "made/xacro/lib/xacro"
    made.mkdir(parents=True)
    (made / "__init__.py").write_text(
        "def get_include_files(): pass\ndef main(): print('<robot/>', file=__import__('sys').stdout)\n",
        encoding="utf-8",
    )
    (made / "substitution_args.py").write_text("os = None\n", encoding="utf-8")
    assert read_without_library(write(tmp_path / "in/a.xacro", ""), made=tmp_path / "made").text == "<robot/>\n"
