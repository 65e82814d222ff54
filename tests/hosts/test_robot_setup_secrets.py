"""No password is seen in a process, or left in a file, log or history, by set-ups that end and by those that do not."""

import os
import pty
import subprocess
import threading

from tests.hosts.bench import UR, Machine, boot, wait_until
from tests.hosts.test_robot_setup import PASSWORD, command, prepare, set_up
from tests.hosts.test_robot_setup_interrupted import run_until
from tests.hosts.watch import Watcher, find_written

FLASHED = "flashed-secret-31415"
MISTAKEN = "mistaken-secret-16180"
SECRETS = (FLASHED, PASSWORD, MISTAKEN)


class MachineTerminal:
    """An interactive shell of a computer's user, at a terminal of its own; `screen` is all that was shown there."""

    def __init__(self, machine: Machine, user: str) -> None:
        self._hand, end = pty.openpty()
        words = machine.command_line("exec bash -i", user=user)
        words[words.index("-c")] = "--session-command"  # the session that has the terminal
        self.process = subprocess.Popen(["setsid", "--ctty", "--wait", *words], stdin=end, stdout=end, stderr=end)
        os.close(end)
        self.screen = ""
        self._seen = 0
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        while True:
            try:
                more = os.read(self._hand, 4096)
            except OSError:  # the shell is gone
                return
            self.screen += more.decode(errors="replace")

    def answer(self, question: str, text: str) -> None:
        """Wait until this is shown, after what was answered before, and type a line."""
        wait_until(lambda: question in self.screen[self._seen :], f"{question!r} in {self.screen}", 180)
        self._seen = self.screen.index(question, self._seen) + len(question)
        os.write(self._hand, f"{text}\n".encode())

    def close(self) -> None:
        """Wait for the shell's end."""
        self.process.wait(60)
        self._reader.join(60)
        os.close(self._hand)


def test_watcher_sees_command_lines_and_environments() -> None:
    with Watcher((MISTAKEN,)) as watcher:
        for words, environment in ((["--password", MISTAKEN], {}), ([], {"PASSWORD": MISTAKEN})):
            seen = len(watcher.seen)
            with subprocess.Popen(["sh", "-c", "read x", *words], stdin=subprocess.PIPE, env=environment):
                wait_until(lambda seen=seen: len(watcher.seen) > seen, "it is seen", 60)  # type: ignore[misc] # of a lambda


def test_no_password_is_seen_in_a_process_or_left_in_a_file() -> None:
    with boot(("laptop", "robot")) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        prepare(laptop)
        robot.run("chpasswd", stdin=f"ros:{FLASHED}\n").check()
        with Watcher(SECRETS) as watcher:
            set_up_in_every_way(laptop, robot)
        assert watcher.seen == set()
        assert watcher.looked > 500
        for machine in (laptop, robot):
            assert find_written(machine, SECRETS) == []
        # That the search finds what there is:
        assert any(".bash_history" in path for path in find_written(laptop, ["ur robot setup robot.local --name bob"]))
        laptop.run(f"logger {MISTAKEN}; echo {MISTAKEN} >/tmp/x; echo {MISTAKEN} >/var/tmp/x").check()
        assert len(find_written(laptop, SECRETS)) >= 3


def set_up_in_every_way(laptop: Machine, robot: Machine) -> None:
    """Wrong password, killed, cut off, typed at a terminal, a second time; and the doctor, let in by password."""
    assert set_up(laptop, current=MISTAKEN, new="").code == 2

    def kill(number: int) -> None:
        laptop.run(f"kill -KILL {number}")

    def cut(_: int) -> None:
        robot.cut()

    line, passwords = command("robot.local", "bob"), f"{FLASHED}\n{PASSWORD}\n"
    for point, strike in (("ssh folder", kill), ("packages", kill), ("groups", cut), ("password", kill)):
        said, _ = run_until(laptop, line, passwords, {f"bob: {point}": strike})
        assert f"bob: {point}" in said
        robot.restore()

    terminal = MachineTerminal(laptop, "pat")
    terminal.answer("$ ", "ur robot setup robot.local --name bob --base magni --no-programs")
    terminal.answer("variant of bob", "plain")
    terminal.answer("may bob log in to this computer", "y")
    terminal.answer("present password of ros@robot.local", FLASHED)
    terminal.answer("new password", PASSWORD)
    terminal.answer("the same again", PASSWORD)
    terminal.answer("ready after", "history -a; exit")
    terminal.close()
    assert not any(secret in terminal.screen for secret in SECRETS)
    assert "or the fingerprint]" not in terminal.screen  # an interrupted run has confirmed it already

    assert "nothing to do" in set_up(laptop, "bob.local", current=FLASHED).check().out
    robot.run("mv /home/ros/.ssh/authorized_keys /root/").check()
    looked = laptop.run(f"{UR} doctor bob --password-from 0", user="pat", stdin=f"{PASSWORD}\n", timeout=120)
    assert "key-refused" in looked.out
