"""`ur launch` with a real master: processes, signals, terminals."""

import fcntl
import os
import signal
import struct
import subprocess
import sys
import termios
import xmlrpc.client
from pathlib import Path
from typing import Any

import psutil
import pytest

pytestmark = pytest.mark.ros

SLEEPER = '<node pkg="little_nodes" type="sleeper" name="sleeper"/>'


def ask_master(port: int, method: str, *arguments: Any) -> Any:
    proxy: Any = xmlrpc.client.ServerProxy(f"http://localhost:{port}")
    code, _, value = getattr(proxy, method)("/test", *arguments)
    return value if code == 1 else None


def get_parameter(port: int, name: str) -> Any:
    return ask_master(port, "getParam", name)


def registered(port: int) -> set[str]:
    return {node for kind in ask_master(port, "getSystemState") for _, nodes in kind for node in nodes}


def test_launch_starts_master_and_nodes_and_leaves_nothing(world: Any) -> None:
    run = world.launch(
        '<param name="number" value="3"/><param name="printed" command="echo 2.5"/>'
        '<node pkg="little_nodes" type="show" name="show" ns="deep" args="one \'two words\'" output="screen">'
        '<remap from="a" to="b"/><env name="MINE" value="yes"/></node>'
    )
    run.until("args: ", "uri: ")
    assert f"args: one two words a:=b __name:=show __log:={world.folder}/ros/log/" in run.text
    assert f"cwd: {world.folder}/ros\n" in run.text
    assert "ns: /deep\n" in run.text
    assert "mine: yes\n" in run.text
    assert f"uri: http://localhost:{world.port}\n" in run.text
    assert get_parameter(world.port, "/number") == 3
    assert get_parameter(world.port, "/printed") == 2.5
    assert get_parameter(world.port, "/ur/base_name") == "stage"
    assert get_parameter(world.port, "/rosdistro") == "Debian\n"
    folder = Path(world.folder, "ros/log", get_parameter(world.port, "/run_id"))
    assert (folder / "master.log").exists()
    assert "ns: /deep" in (folder / "deep-show-2-stdout.log").read_text()
    assert folder.stat().st_mode & 0o777 == 0o700
    assert {path.stat().st_mode & 0o777 for path in folder.glob("*-stdout.log")} == {0o600}
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    run.wait_nothing_left()


def test_launch_uses_and_keeps_the_master_that_is_there(world: Any, master: int) -> None:
    run = world.launch(
        '<param name="x" value="1"/><node pkg="little_nodes" type="talker" name="talker" output="screen"/>'
    )
    run.until("] up")
    assert "/talker" in registered(master)
    [talker] = [each for each in run.seen.values() if "talker" in " ".join(each.cmdline())]
    talker.kill()
    assert run.wait() == 0
    assert "error: /talker died: signal SIGKILL (killed)" in run.text
    assert "/talker" not in registered(master)
    assert get_parameter(master, "/x") == 1


@pytest.mark.parametrize("signum", [signal.SIGTERM, signal.SIGHUP])
@pytest.mark.usefixtures("master")
def test_signals_stop_the_run_cleanly(world: Any, signum: int) -> None:
    run = world.launch(SLEEPER)
    run.until("[/sleeper] started")
    run.process.send_signal(signum)
    assert run.wait() == 0
    run.wait_nothing_left()


@pytest.mark.usefixtures("master")
def test_second_interrupt_is_faster(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="stubborn" name="stubborn"/>', "--sigint-timeout", "60")
    run.until("trapped")
    for text in ("stopping: SIGINT", "/stubborn did not stop: SIGTERM", "/stubborn did not stop: SIGKILL"):
        while text not in run.text:  # one that follows at once is no second request
            run.process.send_signal(signal.SIGINT)
            assert run.read() or run.process.poll() is None
    assert run.wait() == 0
    run.wait_nothing_left()


PAIRS = [("host", "guard"), ("supervisor", "guard"), ("supervisor", "host")]


@pytest.mark.parametrize("victims", [("supervisor",), ("host",), ("guard",), *PAIRS], ids=" and ".join)
def test_nothing_survives_kill_9(world: Any, victims: tuple[str, ...]) -> None:
    run = world.launch(
        SLEEPER
        + '<node pkg="little_nodes" type="stubborn" name="stubborn"/>'
        + '<node pkg="little_nodes" type="daemon" name="daemon"/>'
    )
    run.until("[/daemon] started", "trapped")
    run.until_running("sleep 600", 3)
    supervisor = psutil.Process(run.process.pid)
    [guard] = [each for each in supervisor.children() if each.cmdline()[0] == "ur-guard"]
    [host] = guard.children()
    found = {"supervisor": supervisor, "host": host, "guard": guard}
    for victim in victims:
        found[victim].suspend()  # so that none sees another die first
    for victim in victims:
        found[victim].kill()
    if victims == ("guard",):  # one of three does not matter
        run.process.send_signal(signal.SIGINT)
    run.wait_nothing_left()
    codes = {("host",): 1, ("guard",): 0, PAIRS[0]: 1}
    assert run.wait() == codes.get(victims, -signal.SIGKILL)


@pytest.mark.usefixtures("master")
def test_nodes_share_a_session_without_a_terminal_and_lead_a_group_each(world: Any) -> None:
    run = world.launch(SLEEPER + SLEEPER.replace('name="sleeper"', 'name="other"'), terminal=True)
    run.until("[/sleeper] started", "[/other] started")
    run.until_running("sleep 600", 2)
    nodes = [pid for pid, each in run.seen.items() if "sleep" in each.name()]
    assert {os.getpgid(pid) for pid in nodes} == set(nodes)
    [session] = {os.getsid(pid) for pid in nodes}
    assert session != os.getsid(run.process.pid)
    assert all(psutil.Process(pid).terminal() is None for pid in nodes)


@pytest.mark.usefixtures("master")
def test_daemons_are_ended_with_the_run(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="daemon" name="daemon"/>')
    run.until("[/daemon] started")
    run.until_running("sleep 600", 2)
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    run.wait_nothing_left()


@pytest.mark.usefixtures("master")
def test_required_node_that_dies_ends_the_run(world: Any) -> None:
    run = world.launch(SLEEPER + '<node pkg="little_nodes" type="crash" name="crash" required="true"/>')
    assert run.wait() == 0
    assert "error: /crash died: exit code 3, which ends the run\n  | last words\n" in run.text
    assert f"  log: {world.folder}/ros/log/" in run.text
    run.wait_nothing_left()


@pytest.mark.usefixtures("master")
def test_crash_report_names_signal_and_last_lines(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="segfault" name="segfault" output="screen"/>')
    run.wait()
    assert "[/segfault] about to fault\n" in run.text
    assert "error: /segfault died: signal SIGSEGV (segmentation fault)\n  | about to fault\n" in run.text


@pytest.mark.usefixtures("master")
def test_respawned_node_comes_back(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="crash" name="crash" respawn="true" respawn_delay="0.05"/>')
    run.until("starts again in 0.05 s")
    while run.text.count("[/crash] started") < 2:
        assert run.read(5)


def test_missing_executables_are_found_before_anything_starts(world: Any) -> None:
    run = world.launch(
        SLEEPER + '<node pkg="little_nodes" type="slepper" name="a"/><node pkg="litle_nodes" type="sleeper" name="b"/>'
    )
    assert run.wait() == 1
    assert "/a: package 'little_nodes' has no executable 'slepper'" in run.text
    assert "/b: package 'litle_nodes' is not installed" in run.text
    assert "did you mean 'little_nodes'?" in run.text
    assert "started" not in run.text


def test_errors_in_the_launch_file_end_with_1(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes"/>')
    assert run.wait() == 1
    assert "test.launch:1:9: error: " in run.text


@pytest.mark.usefixtures("master")
def test_bad_prefix_is_reported_with_its_name(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="sleeper" name="a" launch-prefix="no_such_debugger --args"/>')
    assert run.wait() == 1
    assert "error: /a could not be started: no_such_debugger: no such file or directory" in run.text


@pytest.mark.usefixtures("master")
def test_viewers_are_left_out_without_a_display(world: Any) -> None:
    run = world.launch(SLEEPER + '<node pkg="rviz" type="rviz" name="viewer"/>')
    run.until("no display: /viewer left out", "[/sleeper] started")


def test_master_elsewhere_that_does_not_answer_is_an_error(world: Any) -> None:
    world.environment["ROS_MASTER_URI"] = "http://no-such-robot.invalid:11311"
    run = world.launch(SLEEPER)
    assert run.wait() == 1
    assert "no ROS master answers at http://no-such-robot.invalid:11311" in run.text


TERMINAL = '<node pkg="little_nodes" type="{}" name="front" args="{}" required="true"><!--terminal: asks--></node>'


def test_terminal_node_reads_piped_input_and_its_exit_code_is_passed_on(world: Any) -> None:
    reader, writer = os.pipe()
    run = world.ur("launch", world.write(TERMINAL.format("ask", "")), stdin=reader)
    os.close(reader)
    os.write(writer, b"one\ntwo\n")
    os.close(writer)
    assert run.wait() == 7
    assert "got one\ngot two\n" in run.text
    assert "[/front]" not in run.text
    run.wait_nothing_left()


@pytest.mark.usefixtures("master")
def test_terminal_node_owns_the_terminal_and_others_are_silent(world: Any) -> None:
    run = world.launch(
        TERMINAL.format("screen", "5") + '<node pkg="little_nodes" type="show" name="show" output="screen"/>',
        terminal=True,
    )
    run.until("ready")
    front = os.tcgetpgrp(run.output)
    assert front != run.process.pid
    assert "screen" in " ".join(psutil.Process(front).cmdline())
    assert not termios.tcgetattr(run.output)[3] & termios.ICANON
    os.write(run.output, b"hello\n")
    assert run.wait() == 5
    assert "got hello" in run.text
    assert "[/show]" not in run.text
    run.wait_nothing_left()


@pytest.mark.usefixtures("master")
def test_terminal_is_restored_after_the_node_was_killed(world: Any) -> None:
    run = world.launch(TERMINAL.format("raw", "") + SLEEPER, terminal=True)
    before = termios.tcgetattr(run.keeper)
    run.until("ready")
    assert termios.tcgetattr(run.keeper) != before
    psutil.Process(os.tcgetpgrp(run.output)).kill()
    assert run.wait() == 128 + signal.SIGKILL
    assert termios.tcgetattr(run.keeper) == before
    assert "\x1b[?1049l" in run.text.rpartition("ready")[2]
    assert "\x1b[?25h" in run.text
    assert "error: /front died: signal SIGKILL (killed)" in run.text


@pytest.mark.usefixtures("master")
def test_required_node_dying_behind_the_terminal_is_reported_afterwards(world: Any) -> None:
    run = world.launch(
        TERMINAL.format("raw", "")
        + '<node pkg="little_nodes" type="crash" name="crash" required="true"'
        + " launch-prefix=\"bash -c 'sleep 0.3; exec $0'\"/>",
        terminal=True,
    )
    assert run.wait() == 1
    assert "error: /crash died: exit code 3, which ends the run" in run.text
    assert "  | first words" in run.text
    run.wait_nothing_left()


def test_count_of_nodes_ends_with_the_first_line_that_is_typed_and_the_program_gets_it(world: Any) -> None:
    world.environment["TERM"] = "xterm"
    world.environment.pop("NO_COLOR", None)
    sleeper = '<node pkg="little_nodes" type="sleeper" name="beside"><!--ready: process--></node>'
    run = world.launch(TERMINAL.format("echo", "") + sleeper, terminal=True)
    fcntl.ioctl(run.keeper, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
    run.until("starting: 1 of 2 up; front takes this terminal in a few seconds")
    os.write(run.output, b"hello\n")
    run.until("got hello")
    os.write(run.output, b"again\n\x04")
    assert run.wait() == 0
    assert "got again" in run.text
    assert "up;" not in run.text[run.text.index("hello") :]


def test_program_refuses_words_that_are_no_arguments(world: Any) -> None:
    run = world.launch(TERMINAL.format("ask", "") + '<arg name="world" default="maze"/>', "--", "--world", "office")
    assert run.wait() == 2
    assert "error: '--world' is not an argument, expected NAME:=VALUE with NAME one of world" in run.text
    assert "help: did you mean world:=...?" in run.text


def test_selection_fills_arguments_that_the_file_declares(world: Any) -> None:
    subprocess.run(
        [sys.executable, "-m", "ur", "use", "sim:magni:lidar"], env=world.environment, check=True, capture_output=True
    )
    run = world.launch(
        '<arg name="robot_base"/><arg name="robot_variant" default=""/>'
        '<node pkg="little_nodes" type="quick" name="q" args="$(arg robot_base)/$(arg robot_variant)" output="screen"/>'
    )
    run.until("[/q] magni/lidar ")


@pytest.mark.usefixtures("master")
def test_suspended_terminal_node_gives_the_terminal_back_until_it_goes_on(world: Any) -> None:
    run = world.launch(TERMINAL.format("ask", ""), terminal=True)
    os.write(run.output, b"one\n")
    run.until("got one")
    front = os.tcgetpgrp(run.output)
    os.write(run.output, b"\x1a")
    supervisor = psutil.Process(run.process.pid)
    while supervisor.status() != psutil.STATUS_STOPPED:
        run.read()
    assert os.tcgetpgrp(run.output) == run.process.pid
    supervisor.resume()
    os.write(run.output, b"two\n")
    run.until("got two")
    assert os.tcgetpgrp(run.output) == front
    os.write(run.output, b"\x04")
    assert run.wait() == 7


@pytest.mark.usefixtures("master")
def test_failing_parameter_command_is_named(world: Any) -> None:
    run = world.launch(SLEEPER + '<param name="x" command="bash -c \'echo sorry >&amp;2; exit 2\'"/>')
    assert run.wait() == 1
    assert "error: " in run.text
    assert "/x: \"bash -c 'echo sorry >&2; exit 2'\" ended with exit code 2: sorry" in run.text
    assert "[/sleeper] started" not in run.text


@pytest.mark.usefixtures("master")
def test_nodes_are_chosen_and_prefixed_on_the_command_line(world: Any) -> None:
    pid_file = world.folder / "pid"
    run = world.launch(
        SLEEPER
        + '<node pkg="little_nodes" type="show" name="show" output="screen"/><node pkg="none" type="x" name="gone"/>',
        "--except=gone",
        "--prefix=show=env MINE=prefixed",
        f"--pid={pid_file}",
    )
    run.until("mine: prefixed", "[/sleeper] started")
    assert pid_file.read_text() == str(run.process.pid)
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    assert not pid_file.exists()


@pytest.mark.usefixtures("master")
def test_closed_terminal_ends_the_run(world: Any) -> None:
    run = world.launch(TERMINAL.format("raw", "") + SLEEPER, terminal=True)
    run.until("ready")
    run.until_running("sleep 600", 2)
    os.close(run.keeper)
    os.close(run.output)
    run.keeper = run.output = -1
    assert run.wait() in (128 + signal.SIGHUP, 0)
    run.wait_nothing_left()


def test_master_of_ours_that_dies_ends_the_run(world: Any) -> None:
    run = world.launch(SLEEPER)
    run.until("[/sleeper] started")
    [master] = [each for each in run.seen.values() if each.name() == "rosmaster"]
    master.kill()
    assert run.wait() == 1
    assert "error: master died: signal SIGKILL (killed), which ends the run" in run.text
    run.wait_nothing_left()


def test_run_without_nodes_keeps_a_master_of_ours_until_stopped(world: Any) -> None:
    run = world.launch('<param name="x" value="1"/>')
    run.until("there is no node to start; the master runs until Ctrl-C")
    while not get_parameter_or_none(world.port, "/x"):
        run.read()
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    run.wait_nothing_left()


def test_run_without_nodes_only_sets_parameters_on_a_master_that_is_there(world: Any, master: int) -> None:
    run = world.launch('<param name="x" value="1"/>')
    assert run.wait() == 0
    assert get_parameter(master, "/x") == 1


def get_parameter_or_none(port: int, name: str) -> Any:
    try:
        return get_parameter(port, name)
    except OSError:  # the master is not there yet
        return None
