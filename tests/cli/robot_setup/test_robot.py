"""`ur robot setup`: what it asks, what it prints on the way, and which robot is selected afterwards."""

from functools import partial
from pathlib import Path

import pytest

from ur.cli.changing import ChangeReporter
from ur.cli.robot_setup.contact import confirm_host_key, decide_robot_login
from ur.cli.robot_setup.questions import ask_task, list_known_tasks, read_tasks
from ur.cli.robot_setup.robot import select_robot
from ur.robot.discovery.record import RobotRecord, render_record
from ur.robot.selection import Selection, load_selection, selection_path, store_selection
from ur.robot.setup.contact import OfferedHostKey
from ur.robot.setup.login import Task
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey
from ur.source.diagnostic import UserError

TASK = Task(Address("ros", "robot.local"), WantedRobot("bob", "magni"))


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CONFIG_HOME", raising=False)
    return tmp_path


class AnsweredQuestions(dict[str, str]):
    """A terminal at which questions that begin with a key get its value, and others their default."""

    def is_there(self) -> bool:
        return True

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:  # noqa: ARG002
        return str(next((value for key, value in self.items() if question.startswith(key)), default))

    def confirm(self, question: str) -> bool:
        self[question] = "y"
        return True


class NoTerminal(AnsweredQuestions):
    """Nobody can be asked."""

    def is_there(self) -> bool:
        return False


@pytest.fixture
def answers() -> AnsweredQuestions:
    return AnsweredQuestions()


def remember(home: Path, record: RobotRecord) -> None:
    folder = home / ".config/ubiquity_launches/robots"
    folder.mkdir(parents=True)
    (folder / f"{record.name}.yaml").write_text(render_record(record))


def test_variant_is_asked_for_and_is_the_plain_one_by_default(answers: AnsweredQuestions) -> None:
    assert ask_task("robot.local", "bob", "magni", None, answers).robot == WantedRobot("bob", "magni")
    answers["variant of bob, a magni (plain, lidar"] = "lidar"
    assert ask_task("robot.local", "bob", "magni", None, answers).robot == WantedRobot("bob", "magni", "lidar")
    assert ask_task("robot.local", "bob", "magni", "plain", answers).robot == WantedRobot("bob", "magni")


def test_answers_of_a_known_robot_are_the_defaults(home: Path, answers: AnsweredQuestions) -> None:
    remember(home, RobotRecord("bob", "ros", "magni", "lidar"))
    assert ask_task("bob", None, None, None, answers).robot == WantedRobot("bob", "magni", "lidar")
    assert ask_task("bob", None, "loki", None, answers).robot == WantedRobot("bob", "loki")


def test_known_variant_stays_where_nobody_can_be_asked(home: Path) -> None:
    assert ask_task("bob", "bob", "magni", None, NoTerminal()).robot == WantedRobot("bob", "magni")
    remember(home, RobotRecord("bob", "ros", "magni", "lidar"))
    assert ask_task("bob", "bob", "magni", None, NoTerminal()).robot == WantedRobot("bob", "magni", "lidar")
    with pytest.raises(UserError, match=r"name of the robot at bob\.local is not given"):
        ask_task("bob", None, "magni", None, NoTerminal())


@pytest.mark.usefixtures("answers")
def test_variant_that_the_base_has_not_is_refused() -> None:
    with pytest.raises(UserError, match="variant 'lydar' of base 'magni' is not known"):
        ask_task("bob", "bob", "magni", "lydar")


def test_all_are_the_robots_that_were_set_up_as_they_are(home: Path) -> None:
    remember(home, RobotRecord("bob", "ubuntu", "magni", "lidar"))
    assert list_known_tasks() == [Task(Address("ubuntu", "bob.local"), WantedRobot("bob", "magni", "lidar"))]


def test_file_of_robots_says_what_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "robots.yaml"
    path.write_text(
        "robots:\n- {host: a.local, name: a, base: magni, programs: false}\n- {host: b, name: b, base: loki}\n"
    )
    assert [(task.robot.programs, task.robot.master) for task in read_tasks(path)[0]] == [(False, True), (True, True)]


@pytest.mark.parametrize(
    ("selected", "after"),
    [(None, "bob"), ("sim", "bob"), ("bob", "bob"), ("robot", "bob"), ("eve", "eve")],
)
def test_robot_is_selected_unless_another_one_is(home: Path, selected: str | None, after: str) -> None:
    path = selection_path({"HOME": str(home)})
    if selected:
        store_selection(path, Selection(selected, ""))
    assert select_robot(TASK) is (after == "bob")
    assert load_selection(path).robot == after


def test_progress_is_one_line_on_a_terminal_and_rare_elsewhere(capsys: pytest.CaptureFixture[str]) -> None:
    report = ChangeReporter("bob", live=True)
    report.show_progress("packages", 3.4, "Get:1 x\x1b[2J")
    report("groups")
    assert capsys.readouterr().out == "\r\033[Kbob: packages, 3 s: Get:1 x\\x1b[2J\r\033[Kbob: groups\n"
    report = ChangeReporter("bob")
    for seconds in (1.0, 2.0, 3.0):
        report.show_progress("packages", seconds, "x")
    assert capsys.readouterr().out == "bob: packages, 1 s: x\n"


KEY = HostKey(f"ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI{'A' * 43}")
OTHER = f"SHA256:{'x' * 43}"


def offer(*_: object, **__: object) -> OfferedHostKey:
    """Meet a robot that offers a host key which this computer does not know."""
    return OfferedHostKey("unknown", KEY)


def test_unknown_host_key_without_a_terminal_needs_a_fingerprint_or_consent(capsys: pytest.CaptureFixture[str]) -> None:
    confirm = partial(confirm_host_key, TASK, terminal=NoTerminal(), handshake=offer)
    with pytest.raises(UserError, match="no terminal to ask on") as caught:
        confirm()
    assert f"--host-key {KEY.fingerprint}" in (caught.value.diagnostics[0].help or "")
    for fingerprint, yes in ((KEY.fingerprint, False), ("", True)):
        done = confirm(fingerprint=fingerprint, yes=yes)
        assert (done.host_key, done.first_contact) == (KEY, True)
        assert KEY.fingerprint in capsys.readouterr().out
    with pytest.raises(UserError, match="expected SHA256:xxx"):
        confirm(fingerprint=OTHER, yes=True)


@pytest.mark.parametrize(
    ("answer", "accepted"), [("y", True), (KEY.fingerprint, True), ("n", False), (OTHER, False), ("", False)]
)
def test_unknown_host_key_is_confirmed_by_yes_or_by_its_fingerprint(
    answers: AnsweredQuestions, answer: str, accepted: bool
) -> None:
    if answer:
        answers["is it the robot's?"] = answer
    if accepted:
        assert confirm_host_key(TASK, terminal=answers, handshake=offer).host_key == KEY
    else:
        with pytest.raises(UserError, match="nothing was sent to it"):
            confirm_host_key(TASK, terminal=answers, handshake=offer)


def test_robot_gets_no_login_here_unless_the_user_wants_it(home: Path) -> None:
    def decide() -> list[bool]:
        return [decide_robot_login([TASK], each, NoTerminal())[0].robot_login for each in (None, False, True)]

    assert decide() == [False, False, True]
    remember(home, RobotRecord("bob", "ros", "magni", robot_login=True))
    assert decide() == [True, False, True]


def test_robot_login_is_asked_for_once(home: Path, answers: AnsweredQuestions) -> None:
    assert decide_robot_login([TASK], None, answers)[0].robot_login
    assert list(answers) == ["may bob log in to this computer by key?"]
    remember(home, RobotRecord("bob", "ros", "magni", robot_login=False))
    assert not decide_robot_login([TASK], None, answers)[0].robot_login
    assert len(answers) == 1


def test_file_of_robots_gives_fingerprints(tmp_path: Path) -> None:
    path = tmp_path / "robots.yaml"
    row = "{{host: a.local, name: a, base: magni, host_key: '{}'}}"
    path.write_text(f"robots:\n- {row.format(OTHER)}\n- {{host: b.local, name: b, base: magni}}\n")
    assert read_tasks(path)[1] == {"a": OTHER}
    path.write_text(f"robots:\n- {row.format('SHA256:short')}\n")
    with pytest.raises(UserError, match="is not the fingerprint of a host key"):
        read_tasks(path)
