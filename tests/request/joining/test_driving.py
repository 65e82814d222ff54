import time
from dataclasses import replace
from typing import Any

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import NodeSpec
from ur.launchfile.world import MemoryWorld
from ur.request.joining.running import ask_mode, choose_mode
from ur.request.launch_request import LaunchOptions, check_options
from ur.run.remote.lease import RobotLease
from ur.source import UserError

HELD = RobotLease("held", "a1", "laptop2", "keyboard_drive", time.time())


def nodes_of(type_: str) -> tuple[NodeSpec, ...]:
    text = f'<launch><node name="keys" pkg="ubiquity_launches" type="{type_}"/></launch>'
    return load_plan(["/a.launch"], [], MemoryWorld(files={"/a.launch": text.encode()})).nodes


KEYS = nodes_of("teleop_twist_keyboard.py")


@pytest.fixture(autouse=True)
def master(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "http://bob.local:11311")


def read_held(_: str) -> RobotLease:
    return HELD


@pytest.mark.parametrize(
    ("answers", "mode"),
    [
        (["w\n"], "watch"),
        (["a"], "ask"),
        (["Take"], "take"),
        (["q"], None),
        (["", "x", "5", "w"], "watch"),
    ],
)
def test_person_is_asked_until_the_answer_is_one_of_those_offered(answers: list[str], mode: str | None) -> None:
    left = iter(answers)
    asked: list[str] = []

    def ask(question: str) -> str:
        asked.append(question)
        return next(left)

    assert ask_mode("laptop2 drives bob", ask) == mode
    assert asked[0].startswith("laptop2 drives bob\n")
    assert len(asked) == len(answers)


def test_end_of_the_input_means_to_quit() -> None:
    def ask(_: str) -> str:
        raise EOFError

    assert ask_mode("laptop2 drives bob", ask) is None


def test_robot_that_is_driven_is_refused_where_nobody_can_be_asked() -> None:
    with pytest.raises(UserError) as caught:
        choose_mode(LaunchOptions(detach=True), "bob", KEYS, "laptop", read=read_held)
    (found,) = caught.value.diagnostics
    assert found.message.startswith("laptop2 drives bob since ")
    assert "(keyboard_drive)" in found.message
    assert all(option in str(found.help) for option in ("--watch", "--ask", "--take-over"))


def test_robot_whose_driver_is_out_of_reach_is_taken_over_on_purpose_only() -> None:
    def read(_: str) -> RobotLease:
        return replace(HELD, state="lost", until=time.time())

    answers, asked = iter(["a", "t"]), []

    def ask(question: str) -> str:
        asked.append(question)
        return next(answers)

    assert choose_mode(LaunchOptions(), "bob", KEYS, "laptop", ask, read) == "take"
    first, second = asked
    assert "laptop2 drove bob until " in first
    assert "is out of reach\n  [w]atch, [t]ake over, [q]uit? " in first
    assert second == "  expected w, t or q: "
    with pytest.raises(UserError, match="out of reach") as caught:
        choose_mode(LaunchOptions(detach=True), "bob", KEYS, "laptop", read=read)
    assert caught.value.diagnostics[0].help == "add --watch or --take-over"


@pytest.mark.parametrize(
    ("options", "mode"),
    [(LaunchOptions(watch=True), "watch"), (LaunchOptions(ask=True), "ask"), (LaunchOptions(take_over=True), "take")],
)
def test_option_says_it_without_a_question(options: LaunchOptions, mode: str) -> None:
    assert choose_mode(options, "bob", KEYS, "laptop", read=read_held) == mode


def test_program_that_commands_nothing_is_not_asked_about() -> None:
    assert choose_mode(LaunchOptions(detach=True), "bob", nodes_of("rviz"), "laptop", read=read_held) == "drive"


def test_free_robot_is_driven_without_a_question() -> None:
    assert choose_mode(LaunchOptions(detach=True), "bob", KEYS, "laptop", read=lambda _: RobotLease()) == "drive"


@pytest.mark.parametrize("given", [{"watch": True, "ask": True}, {"ask": True, "take_over": True}])
def test_options_exclude_each_other(given: dict[str, Any]) -> None:
    with pytest.raises(UserError, match="cannot be used together"):
        check_options(("a.launch",), LaunchOptions(**given))
