#!/usr/bin/env python3
"""Try the Debian root as a user of a release without ROS 1: tests/fresh/brought.py [NAME ...].

tests/fresh/run starts it in the project's folder, after the first README command. It needs only Python and sudo. Every
trial prints what it has measured; the exit code is 1 when one has failed.
"""

import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.fresh.brought_commands import INSIDE, PATIENCE, UR, inside, launch_file, processes, run, wait_for  # noqa: E402
from tests.fresh.brought_runs import trial_interrupt, trial_kill, trial_start, trial_terminal  # noqa: E402

SCRIPT = str(ROOT / "tools" / "debian_root.bash")
DATA = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local/share") / "ubiquity_launches/debian-13"
KILL_AT = (0.01, 0.05, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9)  # of the time that it takes


def trial_identity() -> str:
    """The user, the folder, the host, the time zone and the environment are those outside."""
    line = 'id -u; pwd; uname -n; date +%Z; echo "$UR_TRIAL"; readlink /proc/self/ns/pid; readlink /proc/self/ns/net'
    here = subprocess.run(["bash", "-c", line], capture_output=True, text=True, env={**os.environ, "UR_TRIAL": "a b"})
    there = inside(line, UR_TRIAL="a b")
    assert there.stdout == here.stdout, (there, here)
    assert "trixie" in inside("cat /etc/os-release").stdout
    assert inside("getent hosts localhost && getent passwd $(id -un)").returncode == 0
    return there.stdout.replace("\n", " ")


def trial_home() -> str:
    """With another HOME, the same Debian root is used, and nothing is set up again."""
    with tempfile.TemporaryDirectory() as folder:
        for command in ([UR, "--version"], [UR, "list"], [str(DATA / "bin/rosversion"), "-d"]):
            done = run(*command, HOME=folder)
            assert done.returncode == 0, done
            assert "setting up" not in done.stderr, done
        within = inside(f"HOME={folder} {UR} --version")
        assert (within.returncode, within.stderr) == (0, ""), within
        assert not (Path(folder) / ".local").exists()
    return within.stdout.strip()


def trial_exit_codes() -> str:
    codes = [inside(line).returncode for line in ("exit 7", "kill -9 $$", "kill -TERM $$", "true")]
    assert codes == [7, -9, -15, 0], codes
    return f"exit 7, SIGKILL, SIGTERM, true: {codes}"


def trial_files() -> str:
    with tempfile.TemporaryDirectory(dir=Path.home()) as folder:
        assert inside(f"touch {folder}/a; mkdir {folder}/b").returncode == 0
        owners = {(Path(folder) / name).stat().st_uid for name in "ab"}
        assert owners == {os.getuid()}
    assert inside("touch /usr/bin/not-mine").returncode != 0
    return "files made inside belong to the user; /usr of the root cannot be written"


def trial_device() -> str:
    """A device that is plugged in while a program runs, of a group of the user."""
    name = "/dev/ttyUSB97"
    run("sudo", "usermod", "-aG", "dialout", os.environ.get("USER", "pat"))
    holder = subprocess.Popen([*INSIDE, "sleep", "1000"])
    try:
        wait_for(lambda: Path(f"/proc/{holder.pid}/comm").read_text() == "sleep\n", "a program in the root")
        assert run("sudo", "sh", "-c", f"mknod -m 660 {name} c 1 5 && chgrp dialout {name}").returncode == 0
        line = f"{UR} setup debian shell head -c 4 {name} | wc -c"
        read = run("sudo", "-E", "-u", os.environ.get("USER", "pat"), "bash", "-c", line)
        assert read.stdout.strip() == "4", read
        return f"4 bytes read from {name} through group dialout"
    finally:
        holder.kill()
        holder.wait()
        run("sudo", "rm", "-f", name)


def trial_agent() -> str:
    """Sockets of this computer: an ssh agent; and ssh accepts the configuration that it finds."""
    agent = inside("ssh-agent -a /tmp/agent-$$; ssh -G robot.local >/dev/null && echo configured")
    try:
        path = re.search(r"SSH_AUTH_SOCK=([^;]+)", agent.stdout)
        assert path, agent
        assert "configured" in agent.stdout, agent
        listed = inside("ssh-add -l", SSH_AUTH_SOCK=path[1])
        assert "no identities" in listed.stdout, listed
    finally:
        ended = re.search(r"SSH_AGENT_PID=(\d+)", agent.stdout)
        if ended:
            os.kill(int(ended[1]), signal.SIGTERM)
    return "an agent answers; ssh -G"


def trial_environment() -> str:
    """`ur env` puts programs of ROS on PATH; check and completion work from outside."""
    line = f'eval "$({UR} env)"; command -v rostopic; rosversion -d; rospack find rospy; rosrun rospy nothing 2>&1'
    done = run("bash", "-c", line)
    for said in ("debian-13/bin/rostopic", "/usr/share/rospy", "find executable"):
        assert said in done.stdout, done
    with launch_file("doze", 2) as path:
        checked = run(UR, "check", str(path))
        assert checked.returncode in (0, 1), checked
    offered = run(UR, "__complete", "bash", "ur run keyb", "keyb")
    assert "keyboard_navigate" in offered.stdout, offered
    assert "Debian 13" in run(UR, "doctor").stdout
    return "rostopic, rosversion, rospack, rosrun; ur check, ur __complete, ur doctor"


def trial_display() -> str:
    """A window of a program of the root appears on the display."""
    if not os.environ.get("DISPLAY"):
        return "left out: no DISPLAY"
    installed = run(UR, "setup", "debian", "install", "x11-apps", "x11-utils")
    assert installed.returncode == 0, installed
    owners = [path.stat().st_uid for path in (DATA / "root/usr/bin/xlogo", Path("/etc/passwd"), Path("/dev/null"))]
    assert owners == [os.getuid(), 0, 0], f"owners of a new program, of /etc/passwd and of /dev/null: {owners}"
    window = subprocess.Popen([*INSIDE, "xlogo"])
    try:
        wait_for(lambda: '"xlogo"' in inside("xwininfo -root -tree").stdout, "a window")
    finally:
        window.terminate()
        window.wait()
    return "xlogo, installed by ur setup debian install, has a window"


def trial_rviz() -> str:
    """RViz, as programs start it, shows its window."""
    if not os.environ.get("DISPLAY"):
        return "left out: no DISPLAY"
    began = time.monotonic()
    installed = run(UR, "setup", "debian", "install", "rviz", "x11-utils")
    assert installed.returncode == 0, installed
    took = time.monotonic() - began
    with socket.socket() as free:
        free.bind(("localhost", 0))
        master = f"http://localhost:{free.getsockname()[1]}"
    with tempfile.TemporaryFile("w+") as said:
        program = subprocess.Popen(
            [UR, "run", "rviz_robot"],
            env={**os.environ, "ROS_MASTER_URI": master},
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=said,
        )

        def has_window() -> bool:
            assert program.poll() is None, f"it has ended with code {program.returncode}"
            return " - RViz" in inside("xwininfo -root -tree").stdout

        try:
            wait_for(has_window, "a window of RViz")
            program.send_signal(signal.SIGINT)
            assert program.wait(PATIENCE) == 0
        except (AssertionError, subprocess.SubprocessError):
            said.seek(0)
            sys.stdout.write(said.read()[-2000:])
            raise
        finally:
            program.kill()
            program.wait()
    assert not processes("__name:=rviz_robot")
    return f"a window of RViz (installed in {took:.0f} s)"


def trial_interruptions() -> str:
    """Killed, without space, without network: the next start makes the root, and nothing is left of the attempts."""
    with tempfile.TemporaryDirectory(dir=Path.home()) as folder:
        mine = {"XDG_DATA_HOME": folder}
        data = Path(folder) / "ubiquity_launches/debian-13"
        making = ["bash", SCRIPT, "install", "less"]
        began = time.monotonic()
        first = run(*making, **mine)
        assert first.returncode == 0, first
        took = time.monotonic() - began
        assert run("bash", SCRIPT, "remove", **mine).returncode == 0
        seen = []
        for number, seconds in enumerate(took * part for part in KILL_AT):
            process = subprocess.Popen(
                making,
                env={**os.environ, **mine},
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
            time.sleep(seconds)
            how = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)[number % 3]
            os.kill(process.pid, how) if how is signal.SIGTERM else os.killpg(process.pid, how)
            process.wait()
            wait_for(lambda: not processes(str(data)), f"end of what was killed after {seconds} s")
            assert str(data) not in Path("/proc/mounts").read_text()
            if (data / "root").exists():  # it was faster this time
                assert run("bash", SCRIPT, "enter", "true", **mine).returncode == 0
                assert run("bash", SCRIPT, "remove", **mine).returncode == 0
            seen.append(f"{seconds:.1f} s {how.name}")
        small = Path(folder) / "small"
        small.mkdir()
        run("sudo", "mount", "-t", "tmpfs", "-o", f"size=60m,uid={os.getuid()},mode=755", "tmpfs", str(small))
        try:
            full = run(*making, XDG_DATA_HOME=str(small))
            assert full.returncode != 0, full
            assert {each.name for each in small.rglob("debian-13/*")} <= {"lock"}
            assert "No space left" in full.stdout + full.stderr
        finally:
            run("sudo", "umount", str(small))
        alone = ["sudo", "unshare", "--net", "sudo", "-u", os.environ.get("USER", "pat"), f"XDG_DATA_HOME={folder}"]
        cut = run(*alone, *making)
        assert cut.returncode != 0, cut
        assert {each.name for each in data.iterdir()} <= {"lock"}
        made = run(*making, **mine)
        assert made.returncode == 0, made
        assert run("bash", SCRIPT, "enter", "true", **mine).returncode == 0
        removed = run("bash", SCRIPT, "remove", **mine)
        assert removed.returncode == 0, removed
        assert not list(Path(folder).rglob("debian-13"))
    return f"{', '.join(seen)}, disk full, no network; then made, and removed (takes {took:.0f} s)"


def trial_remove() -> str:
    """`ur setup debian remove` is refused while a program runs, and leaves nothing. Last: the root is gone then."""
    holder = subprocess.Popen([*INSIDE, "sleep", "1000"])
    wait_for(lambda: Path(f"/proc/{holder.pid}/comm").read_text() == "sleep\n", "a program in the root")
    refused = run(UR, "setup", "debian", "remove")
    assert refused.returncode == 2, refused
    assert str(holder.pid) in refused.stderr, refused
    holder.kill()
    holder.wait()
    removed = run(UR, "setup", "debian", "remove")
    assert removed.returncode == 0, removed
    assert not DATA.exists()
    assert not Path(UR).with_name(".venv").exists()
    return removed.stdout.strip()


TRIALS: dict[str, Callable[[], str]] = {
    trial.__name__.removeprefix("trial_"): trial
    for trial in (
        trial_identity,
        trial_home,
        trial_exit_codes,
        trial_files,
        trial_terminal,
        trial_kill,
        trial_interrupt,
        trial_start,
        trial_device,
        trial_agent,
        trial_environment,
        trial_display,
        trial_rviz,
        trial_interruptions,
        trial_remove,
    )
}


def try_out(name: str) -> bool:
    """Make one trial, print its result, and return whether it succeeded."""
    try:
        sys.stdout.write(f"ok      {name}: {TRIALS[name]()}\n")
    except (AssertionError, OSError, subprocess.SubprocessError) as problem:
        where = traceback.extract_tb(problem.__traceback__)[-1]
        sys.stdout.write(f"FAILED  {name}: line {where.lineno}: {where.line}: {problem}\n")
        return False
    finally:
        sys.stdout.flush()
    return True


def main(names: Sequence[str]) -> int:
    """Make the trials with these names, or all of them, and return the exit code."""
    results = [try_out(name) for name in names or TRIALS]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
