"""Programs with a node: where they find packages, and how they end."""

import logging
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from ur.source.crash import EXIT_CODE
from ur.source.diagnostic import Diagnostic, Severity, UserError
from ur_nodes.run import _collect_crashes, find_package, run_foreground


def test_package_is_found_below_the_prefixes_of_ament(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "b/share/my_robot"
    folder.mkdir(parents=True)
    monkeypatch.setenv("ROS_VERSION", "2")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'a'}:{tmp_path / 'b'}")
    assert find_package("my_robot") == folder
    assert find_package("another") is None
    assert find_package("../share/my_robot") is None
    assert find_package("") is None


@pytest.mark.ros
def test_package_of_ros1_is_found_by_its_index(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "1")
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/usr/share")
    assert find_package("std_msgs") == Path("/usr/share/std_msgs")
    assert find_package("no_such_package") is None


def test_exception_that_ends_a_thread_is_kept_for_the_end() -> None:
    ended, before = threading.Event(), threading.excepthook
    crashes = _collect_crashes(ended)
    try:
        thread = threading.Thread(target=lambda: 1 / 0)
        thread.start()
        thread.join()
    finally:
        threading.excepthook = before
    assert [type(each) for each in crashes] == [ZeroDivisionError]
    assert ended.is_set()


@pytest.fixture
def ends(monkeypatch: pytest.MonkeyPatch) -> Iterator[SimpleNamespace]:
    """A middleware whose node can have been replaced; what `run_foreground` sets in this process is taken back."""
    node = SimpleNamespace(name="/joystick", replaced=False)

    @contextmanager
    def attach(_name: str, start: Callable[[object], object], _end: object) -> Iterator[tuple[object, object]]:
        yield start(node), node

    monkeypatch.setenv("ROS_VERSION", "0")
    monkeypatch.setenv("ROS_LOG_DIR", "/nonexistent")
    monkeypatch.setitem(sys.modules, "ur_nodes.one_process.attached", SimpleNamespace(attach=attach))
    hooks = logging.lastResort, threading.excepthook
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.getsignal(number) for number in numbers]
    yield node
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)
    logging.lastResort, threading.excepthook = hooks


def run_body(body: Callable[[object, threading.Event], int]) -> int:
    return run_foreground("joystick", lambda node: node, body)


def fail_with(problem: Exception) -> Callable[[object, threading.Event], int]:
    def body(_wired: object, _ended: threading.Event) -> int:
        raise problem

    return body


def test_program_with_a_node_ends_with_the_code_of_its_user_interface(ends: SimpleNamespace) -> None:
    assert run_body(lambda wired, _ended: 7 if wired is ends else 8) == 7


@pytest.mark.usefixtures("ends")
def test_signal_tells_the_user_interface_to_return() -> None:
    def body(_wired: object, ended: threading.Event) -> int:
        signal.raise_signal(signal.SIGTERM)
        return 0 if ended.wait(10) else 1

    assert run_body(body) == 0


def test_name_taken_by_another_node_is_said_with_the_way_out(
    ends: SimpleNamespace, capsys: pytest.CaptureFixture[str]
) -> None:
    ends.replaced = True
    assert run_body(lambda _wired, _ended: 0) == 1
    assert "another node registered as /joystick\n  help: __name:=OTHER_NAME" in capsys.readouterr().err


@pytest.mark.usefixtures("ends")
def test_what_the_user_can_mend_ends_with_its_text_and_anything_else_with_a_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_body(fail_with(UserError(Diagnostic(Severity.ERROR, "no joystick", "no-device")))) == 2
    assert "no joystick" in capsys.readouterr().err
    assert run_body(fail_with(ZeroDivisionError("by 0"))) == EXIT_CODE
    told = capsys.readouterr().err
    assert "Traceback" not in told
    assert "joystick" in told


@pytest.mark.usefixtures("ends")
def test_exception_of_a_callback_is_the_end_of_the_program(capsys: pytest.CaptureFixture[str]) -> None:
    def body(_wired: object, ended: threading.Event) -> int:
        thread = threading.Thread(target=lambda: 1 / 0)
        thread.start()
        thread.join()
        return 0 if ended.is_set() else 3

    assert run_body(body) == EXIT_CODE
    assert "ZeroDivisionError" in capsys.readouterr().err
