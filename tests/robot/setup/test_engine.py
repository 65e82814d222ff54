"""Changes as they are applied: the proxy of those that fetch packages, and how far long ones are."""

import getpass
import subprocess
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import ur.system
from ur.robot.setup import engine
from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.engine import apply_change, apply_states, plan_together
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.made import RECORD
from ur.robot.setup.wanted import WantedLine
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell, ShellResult
from ur.source.diagnostic import UserError


def change(command: ChangeScript) -> Change:
    return Change("packages", "", (command,))


def test_command_that_fetches_packages_gets_the_proxy_and_its_own_input(tmp_path: Path) -> None:
    asked: list[bool] = []

    def route() -> Secret:
        asked.append(True)
        return Secret("http://u:word@127.0.0.1:9\nhere.test\n")

    script = f"{{ echo $http_proxy $https_proxy $no_proxy; cat; }} >{tmp_path}/said"
    apply_change(LocalShell(), change(ChangeScript(script, stdin="own\n", fetches=True)), route=route)
    url = "http://u:word@127.0.0.1:9"
    assert (tmp_path / "said").read_text() == f"{url} {url} here.test\nown\n"
    apply_change(LocalShell(), change(ChangeScript(script, stdin="own\n", fetches=True)))
    assert (tmp_path / "said").read_text() == "\nown\n"
    apply_change(LocalShell(), change(ChangeScript(script, stdin="own\n")), route=route)
    assert asked == [True]


def test_last_line_of_the_log_is_shown_while_a_command_runs(tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_text("of an earlier set-up\n")
    seen, shown = tmp_path / "seen", list[tuple[str, str]]()
    done = threading.Event()

    def progress(title: str, _: float, line: str) -> None:
        shown.append((title, line))
        seen.touch()
        done.set()

    script = f"printf 'first\\n50 %%\\rsecond\\n\\n' >>{log}; until [ -e {seen} ]; do sleep 0.01; done"
    apply_change(LocalShell(), change(ChangeScript(script, log=str(log))), progress=progress, pause=0.01)
    assert done.is_set()
    assert set(shown) == {("packages", "second")}


@pytest.mark.parametrize(
    ("output", "line"),
    [
        ("", ""),
        ("Get:1 a\ndlstatus:2:18.675:Retrieving file 2 of 4\nGet:2 b\n", "downloaded 18 %: Retrieving file 2 of 4"),
        ("dlstatus:2:99:Retrieving\npmstatus:a:67.2:Unpacking a:b\n", "installed 67 %: Unpacking a:b"),
        ("Ignoring a\nCollecting b\n  Downloading b.whl (3 MB)\n", "1 of 2 packages: Downloading b.whl (3 MB)"),
        ("Reading ... 5%\rReading ... 10%\r\n\n", "Reading ... 10%"),
    ],
)
def test_output_of_apt_and_pip_says_how_far_they_are(output: str, line: str) -> None:
    script = Path(ur.system.__path__[0], "progress.awk")
    assert subprocess.check_output(["awk", "-v", "count=3", "-f", script], input=output, text=True).strip() == line


def test_change_that_fails_is_explained_by_its_first_line() -> None:
    with pytest.raises(UserError, match="packages: no such thing"):
        apply_change(LocalShell(), change(ChangeScript("echo no such thing >&2; echo more >&2; exit 3", fetches=True)))


class Restless:
    """A state that is never reached: it wants something else each time, as when a computer lies about its files."""

    title = "restless"
    plans = 0

    def request(self, user: str) -> FactsRequest:
        return FactsRequest(user)

    def plan(self, facts: ComputerFacts) -> Change:  # noqa: ARG002 - of the protocol
        self.plans += 1
        return Change(self.title, f"line {self.plans}", (ChangeScript("true"),))

    def undo(self, facts: ComputerFacts) -> None:  # noqa: ARG002 - of the protocol
        return None


def test_set_up_that_never_comes_to_an_end_is_ended() -> None:
    restless, facts = Restless(), ComputerFacts("pat", "/home/pat", "laptop", "", "", frozenset())
    with pytest.raises(UserError, match="still not as wanted"):
        engine.apply_states(
            LocalShell(),
            lambda _: [restless],
            "pat",
            FactsRequest("pat"),
            root=False,
            report=lambda _change: None,
            ask=lambda *_: facts,
        )
    assert restless.plans == engine.MOST_CHANGES


FACTS = ComputerFacts("ros", "/home/ros", "robot", "", "", frozenset())


@dataclass(frozen=True)
class Item:
    """A wanted state that is missing, of these files or packages."""

    title: str
    files: tuple[str, ...] = ()
    packages: tuple[str, ...] = ()

    def request(self, user: str) -> FactsRequest:
        return FactsRequest(user, files=frozenset(self.files), packages=frozenset(self.packages))

    def plan(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        return Change(self.title, "", ())

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        return None


@pytest.mark.parametrize(
    ("items", "together"),
    [
        ([Item("a", ("/a",)), Item("b", ("/b",)), Item("nothing")], ["a", "b", "nothing"]),
        ([Item("a", ("~/x", RECORD)), Item("b", ("~/y", RECORD))], ["a", "b"]),
        ([Item("a", ("/x",)), Item("b", ("/x",))], ["a"]),
        ([Item("a", ("~/.ssh",)), Item("b", ("~/.ssh/key",))], ["a"]),
        ([Item("a", ("~/.sshd",)), Item("b", ("~/.ssh",))], ["a", "b"]),
        ([Item("a", ("/a",)), Item("b", (), ("rsync",)), Item("c", ("/c",))], ["a", "b"]),
        ([Item("a", ("/base",)), Item("b", ("/b",))], ["a"]),
    ],
)
def test_changes_are_made_together_unless_one_may_alter_another(items: list[Item], together: list[str]) -> None:
    found = plan_together(items, FACTS, "ros", FactsRequest("ros", files=frozenset({"/base"})))
    assert [change.title for change in found] == together


def test_independent_changes_need_no_look_between_them_and_all_are_as_wanted(tmp_path: Path) -> None:
    looks: list[str] = []

    class CountedShell(LocalShell):
        def run(self, script: str, **more: Any) -> ShellResult:
            looks.extend(["look"] if "mark end" in script else [])
            return super().run(script, **more)

    user = getpass.getuser()
    names = ("a", "b", "c")
    wanted = [WantedLine(name, str(tmp_path / name), name) for name in names]
    _, count = apply_states(
        CountedShell(), lambda _: wanted, user, FactsRequest(user), root=False, report=lambda _: None
    )
    assert count == 3
    assert [(tmp_path / name).read_text() for name in names] == ["a\n", "b\n", "c\n"]
    # At first it is not known what to look at: once for that, once before the changes, once after them.
    assert len(looks) == 3
