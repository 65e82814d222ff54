"""Packages of a folder: who owns it, and what is in it under another name."""

import subprocess
from pathlib import Path

import pytest

from ur.get.folder import find_renamed, folder_needs, hints_above
from ur.get.index import Index
from ur.get.owners import ask_server, confirm_guesses, owners_of_config, owners_of_manifest
from ur.get.plan import Tables, make_plan
from ur.get.render import render_plan
from ur.get.steps import Missing
from ur.source.diagnostic import UserError

OWNER = "https://github.com/somebody"


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def package(folder: Path, name: str, **files: str) -> None:
    write(folder / "package.xml", f"<package><name>{name}</name></package>")
    for file, text in files.items():
        write(folder / "launch" / f"{file}.launch", f"<launch>{text}</launch>")


def reasons(folder: Path) -> dict[str, str]:
    needs = folder_needs([str(folder)], {})
    return {
        step.missing.package: step.reason for step in make_plan(needs.missing, Tables({}, {}), bool).steps if step.here
    }


@pytest.mark.parametrize(
    "url",
    [
        "https://github.com/somebody/robot.git",
        "https://github.com/somebody/robot",
        "https://token@github.com/somebody/robot.git",
        "git@github.com:somebody/robot.git",
        "ssh://git@github.com/somebody/robot.git",
    ],
)
def test_owner_is_read_from_every_form_of_a_remote(url: str) -> None:
    assert owners_of_config(f'[remote "origin"]\n\turl = {url}\n\tfetch = +refs\n') == (OWNER,)


@pytest.mark.parametrize("url", ["https://github.com/a;b/c", "https://github.com/a/b/../c", "/home/me/robot", "-u/x"])
def test_address_of_another_form_has_no_owner(url: str) -> None:
    assert not owners_of_config(f"url = {url}\n")


def test_owner_is_read_from_the_repository_of_a_package_xml() -> None:
    assert owners_of_manifest(f'<url type="website">http://x</url><url type="repository">{OWNER}/robot</url>') == (
        OWNER,
    )


def test_repository_of_the_owner_is_a_source_once_the_server_confirms_it() -> None:
    missing = [Missing("robot_arm", owners=(OWNER,)), Missing("secret", owners=(OWNER,))]
    confirmed = confirm_guesses(missing, lambda url: ["main"] * (url == f"{OWNER}/robot-arm.git"))
    assert {name: each and each.url for name, each in confirmed.items()} == {
        "robot_arm": f"{OWNER}/robot-arm.git", "secret": None,
    }  # fmt: skip
    shown = render_plan(make_plan(missing, Tables({}, {}, index=Index(), confirmed=confirmed), bool))
    assert f"robot_arm: {OWNER}/robot-arm.git; no index has it; the owner of this folder's repository has one" in shown
    assert f"ask its author; {OWNER} has no public repository of this name" in shown


def test_server_that_cannot_be_asked_is_asked_once_and_the_guess_is_named_as_one() -> None:
    asked: list[str] = []
    assert not confirm_guesses(
        [Missing("a", owners=(OWNER,)), Missing("b", owners=(OWNER,))], lambda url: asked.append(url)
    )
    assert asked == [f"{OWNER}/a.git"]
    (step,) = make_plan([Missing("a", owners=(OWNER,))], Tables({}, {}, index=Index()), bool).steps
    assert step.way == "unknown"
    assert step.reason.endswith(f"perhaps it is beside the folder's repository: git ls-remote {OWNER}/a.git")


@pytest.mark.parametrize(
    ("code", "stderr", "answer"),
    [
        (0, "", ()),
        (128, "fatal: could not read Username for 'https://github.com': terminal prompts disabled", ()),
        (128, "remote: Repository not found.", ()),
        (128, "fatal: unable to access: Could not resolve host: github.com", None),
    ],
)
def test_answer_of_git_tells_an_absent_repository_from_no_network(
    code: int, stderr: str, answer: tuple[str, ...] | None
) -> None:
    done = subprocess.CompletedProcess([], code, "", stderr)
    assert ask_server(f"{OWNER}/a.git", lambda _command, _environment: done) == answer


def test_owner_of_the_repository_that_names_a_package_is_asked_first(tmp_path: Path) -> None:
    for name in ("one", "two"):
        package(tmp_path / name, name, a=f'<node pkg="{name}_driver" type="a" name="a"/>')
        write(tmp_path / name / ".git" / "config", f"[remote]\nurl = git@github.com:{name}/robot.git\n")
    found = folder_needs([str(tmp_path)], {}).missing
    assert {each.package: each.owners for each in found} == {
        "one_driver": ("https://github.com/one",),
        "two_driver": ("https://github.com/two",),
    }


def test_folder_below_a_repository_has_its_owner(tmp_path: Path) -> None:
    package(tmp_path / "robot" / "drive", "drive", a='<node pkg="absent" type="a" name="a"/>')
    write(tmp_path / "robot" / ".git" / "config", "url = https://gitlab.com/me/robot.git\n")
    (found,) = folder_needs([str(tmp_path / "robot" / "drive")], {}).missing
    assert found.owners == ("https://gitlab.com/me",)


def test_package_under_another_name_is_found_by_the_files_that_are_expected_in_it(tmp_path: Path) -> None:
    package(tmp_path / "nav", "robot_nav", map="", go='<include file="$(find old_nav)/launch/map.launch"/>')
    assert reasons(tmp_path) == {
        "old_nav": (
            "no package has this name, which nav/launch/go.launch names; robot_nav of this folder has the files that"
            " are expected in it: probably it is meant"
        )
    }


def test_package_whose_file_would_include_itself_is_not_meant(tmp_path: Path) -> None:
    package(tmp_path / "nav", "robot_nav", go='<include file="$(find vendor_bringup)/launch/go.launch"/>')
    assert not reasons(tmp_path)


def test_package_below_another_one_is_named_with_its_folder(tmp_path: Path) -> None:
    package(tmp_path / "robot", "robot", a='<include file="$(find arm)/launch/b.launch"/>')
    package(tmp_path / "robot" / "parts", "arm", b="")
    assert "it is in robot/parts, where ROS does not find it" in reasons(tmp_path)["arm"]


def test_of_two_packages_that_fit_none_is_meant() -> None:
    def has_file(name: str, path: str) -> bool:
        return path.startswith(name)

    assert find_renamed("Robot-Nav", (), ["robot_nav", "arm"], has_file) == "robot_nav"
    assert not find_renamed("x", ("a/1", "b/1"), ["a", "b"], has_file)
    assert find_renamed("x", ("a/1", "a/2", "a/3", "a/4", "b/1"), ["a", "b"], has_file) == "a"
    assert not find_renamed("x", (), ["a", "b"], has_file)


def test_repository_that_has_the_name_of_a_package_is_not_asked_for_again(tmp_path: Path) -> None:
    package(tmp_path, "nav", go='<include file="$(find Robot)/launch/a.launch"/>')
    write(tmp_path / ".git" / "config", f"url = {OWNER}/robot.git\n")
    write(tmp_path / "README.md", f"git clone {OWNER}/robot.git")
    (missing,) = folder_needs([str(tmp_path)], {}).missing
    assert not confirm_guesses([missing], lambda _: ["main"])
    assert "the repository at . has this name, and no package.xml in it has" in reasons(tmp_path)["Robot"]


def test_placeholder_of_an_example_is_named_as_one(tmp_path: Path) -> None:
    package(tmp_path, "nav", go='<node pkg="your_package_name" type="a" name="a"/>')
    assert "put the name of your package there" in reasons(tmp_path)["your_package_name"]


def test_what_a_folder_clones_comes_before_what_it_links_to_and_never_the_folder_itself(tmp_path: Path) -> None:
    write(tmp_path / ".git" / "config", f"url = git@github.com:{OWNER.rpartition('/')[2]}/robot.git\n")
    package(tmp_path / "nav", "nav", go='<!-- https://github.com/b/odom --><node pkg="odom" type="a" name="a"/>')
    write(tmp_path / "README.md", f"git clone https://github.com/a/odom.git\ngit clone {OWNER}/robot")
    write(tmp_path / ".gitmodules", '[submodule "x"]\n\tpath = x\n\turl = ../arm.git\n')
    hints = folder_needs([str(tmp_path)], {}).hints
    assert [each.url for each in hints] == [
        f"{OWNER}/arm.git",
        "https://github.com/a/odom.git",
        "https://github.com/b/odom",
    ]


def test_launch_file_alone_has_the_hints_of_its_repository(tmp_path: Path) -> None:
    package(tmp_path / "robot" / "nav", "nav", go="<!-- https://github.com/b/odom -->")
    write(tmp_path / "robot" / ".git" / "config", f"url = {OWNER}/robot.git\n")
    write(tmp_path / "robot" / "README.md", f"git clone https://github.com/a/lidar.git; {OWNER}/robot")
    write(tmp_path / "README.md", "git clone https://github.com/a/other.git")
    file = tmp_path / "robot" / "nav" / "launch" / "go.launch"
    assert [each.url for each in hints_above(file)] == [
        "https://github.com/a/lidar.git",
        "https://github.com/b/odom",
    ]


def test_owners_of_repositories_that_a_folder_clones_are_asked_after_its_own(tmp_path: Path) -> None:
    package(tmp_path, "nav", go='<node pkg="arm" type="a" name="a"/><node pkg="leg" type="a" name="b"/>')
    write(tmp_path / ".git" / "config", f"url = {OWNER}/robot.git\n")
    write(tmp_path / "README.md", "git clone https://github.com/other/base.git")
    missing = folder_needs([str(tmp_path)], {}).missing
    asked: list[str] = []

    def list_branches(url: str) -> list[str]:
        asked.append(url)
        return ["main"] if "other/arm" in url else []

    confirmed = confirm_guesses(missing, list_branches)
    assert asked == [
        f"{OWNER}/arm.git",
        f"{OWNER}/leg.git",
        *(f"https://github.com/other/{n}.git" for n in ("arm", "leg")),
    ]
    (step, _) = make_plan(missing, Tables({}, {}, index=Index(), confirmed=confirmed), bool).steps
    assert "an owner of a repository that a file of this folder names" in step.reason


@pytest.mark.parametrize(
    ("branches", "chosen"),
    [
        (["foxy", "galactic", "melodic"], "melodic"),
        (["jazzy", "indigo", "kinetic", "noetic"], "noetic"),
        (["master", "noetic-devel", "noetic-devel-fix"], "noetic-devel"),
        (["ros2", "ros1"], "ros1"),
        (["noetic-devel", "noetic"], ""),
        (["main", "humble"], ""),
        (["ros2", "--noetic"], ""),
        ([], ""),
    ],
)
def test_branch_for_ros_1_is_chosen_by_its_name(branches: list[str], chosen: str) -> None:
    found = confirm_guesses([Missing("arm", owners=(OWNER,))], lambda _: branches)["arm"]
    assert (found.version if found else "") == chosen


def test_owner_of_a_linked_repository_is_asked_for_packages_of_its_family_only(tmp_path: Path) -> None:
    nodes = "".join(f'<node pkg="{name}" type="a" name="{name}"/>' for name in ("scuttle_model", "arm_model"))
    package(tmp_path, "nav", go=nodes)
    write(tmp_path / "README.md", "see https://github.com/makers/scuttle_driver")
    found = {each.package: each.others for each in folder_needs([str(tmp_path)], {}).missing}
    assert found == {"scuttle_model": ("https://github.com/makers",), "arm_model": ()}


def test_folder_without_a_file_to_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "robot.launch.py").write_text("")
    with pytest.raises(UserError, match="no readable launch file"):
        folder_needs([str(tmp_path)], {})
