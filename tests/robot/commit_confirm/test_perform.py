"""The viewer's way back to a robot that changes, and what it says when there is none."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field

import pytest

from ur.robot.commit_confirm.guard import BUSY, EARLY, ENDED, LATE
from ur.robot.commit_confirm.guarded import GuardedChange, Order
from ur.robot.commit_confirm.perform import (
    GRACE,
    ChangeAddresses,
    RootShell,
    come_back,
    hand_over,
    is_doubtful,
    refuse_pending,
)
from ur.robot.setup.facts import ComputerFacts
from ur.robot.ssh.address import Address
from ur.robot.ssh.failures import lost_connection
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import ShellResult
from ur.source.diagnostic import UserError, error

OLD, NEW = Address("ros", "bob.local"), Address("ros", "eve.local")
TITLE = "rename bob to eve"
FACTS = ComputerFacts("ros", "/home/ros", "bob", "", "1", frozenset())
AWAY = UserError(error("no computer answers to this name", rule="unknown-host"))


@dataclass
class AnsweringNetwork:
    """Computers that answer one after the other: for each address what happens, the last for ever."""

    answers: dict[Address, list[ShellResult | UserError]]
    now: float = 0.0
    asked: list[tuple[Address, str]] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def open_link(self, address: Address) -> AbstractContextManager[RootShell]:
        @contextmanager
        def link() -> Iterator[RootShell]:
            rest = self.answers[address]
            answer = rest.pop(0) if len(rest) > 1 else rest[0]
            if isinstance(answer, UserError):
                raise answer
            yield _Link(address, answer, self.asked)

        return link()

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def come_back(self) -> Address:
        return come_back(
            "abc",
            TITLE,
            ChangeAddresses((NEW,), OLD),
            60,
            [],
            self.open_link,
            report=self.said.append,
            clock=lambda: self.now,
            sleep=self.sleep,
        )


@dataclass
class _Link:
    address: Address
    answer: ShellResult
    asked: list[tuple[Address, str]]

    @property
    def destination(self) -> str:
        return str(self.address)

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:
        assert root
        del stdin, timeout
        self.asked.append((self.address, script))
        return self.answer

    def find_sudo(self, candidates: Sequence[Secret]) -> bool:
        return not candidates


def test_change_is_confirmed_over_the_new_way_only() -> None:
    network = AnsweringNetwork(
        {NEW: [AWAY, ShellResult(EARLY, "", ""), ShellResult(0, "", "")], OLD: [ShellResult(EARLY, "", ""), AWAY]}
    )
    assert network.come_back() == NEW
    assert network.said == ["ros@eve.local: answers, confirmed"]
    assert ["confirmed" in script for address, script in network.asked if address == OLD] == [False]
    assert all("confirmed" in script for address, script in network.asked if address == NEW)


def test_confirmation_whose_answer_was_lost_counts() -> None:
    network = AnsweringNetwork(
        {NEW: [lost_connection("x", ""), ShellResult(ENDED, "abc\nconfirmed\n\n", "")], OLD: [AWAY]}
    )
    assert network.come_back() == NEW


@pytest.mark.parametrize("way", [NEW, OLD])
def test_change_that_was_taken_back_is_told_with_its_reason(way: Address) -> None:
    answers: dict[Address, list[ShellResult | UserError]] = {NEW: [AWAY], OLD: [AWAY]}
    answers[way] = [
        ShellResult(LATE, "", ""),
        ShellResult(ENDED, "abc\ntaken-back\nit was not confirmed within 60 s\n", ""),
    ]
    with pytest.raises(UserError) as caught:
        AnsweringNetwork(answers).come_back()
    (problem,) = caught.value.diagnostics
    assert problem.message == "rename bob to eve: the robot reverted the change: it was not confirmed within 60 s"
    assert problem.rule == "taken-back"
    seen = [] if way == NEW else ["seen from here: no computer answers to this name"]
    assert [note.message for note in problem.notes] == seen


def test_robot_that_was_never_told_has_not_changed() -> None:
    network = AnsweringNetwork({NEW: [AWAY], OLD: [ShellResult(ENDED, "other\nconfirmed\n\n", "")]})
    with pytest.raises(UserError, match="nothing was changed"):
        network.come_back()


def test_robot_that_is_not_seen_again_is_told_with_what_to_do() -> None:
    network = AnsweringNetwork({NEW: [AWAY], OLD: [AWAY]})
    with pytest.raises(UserError) as caught:
        network.come_back()
    (problem,) = caught.value.diagnostics
    assert "bob.local has not answered" in problem.message
    assert "reverts the change by itself" in (problem.help or "")
    assert network.now >= 60 + GRACE


def test_change_that_failed_there_is_not_blamed_on_the_way_from_here() -> None:
    failed = ShellResult(ENDED, "abc\ntaken-back\nsecrets were required\n", "")
    with pytest.raises(UserError) as caught:
        AnsweringNetwork({NEW: [AWAY], OLD: [failed]}).come_back()
    assert caught.value.diagnostics[0].notes == ()


def test_other_change_that_is_pending_is_named() -> None:
    with pytest.raises(UserError) as caught:
        hand_over(_Link(OLD, ShellResult(BUSY, "rename bob to tom\npat@desktop\n", ""), []), order(), FACTS)
    assert "'rename bob to tom', begun by pat@desktop, is not finished" in str(caught.value)
    assert not is_doubtful(caught.value)


def test_change_that_is_pending_is_named_before_anything_is_looked_at() -> None:
    with pytest.raises(UserError, match="'rename bob to tom', begun by pat@desktop, is not finished"):
        refuse_pending(_Link(OLD, ShellResult(BUSY, "rename bob to tom\npat@desktop\n", ""), []))
    refuse_pending(_Link(OLD, ShellResult(0, "", ""), []))


def test_robot_that_cannot_hold_the_way_back_is_not_changed() -> None:
    with pytest.raises(UserError) as caught:
        hand_over(_Link(OLD, ShellResult(1, "", "cp: No space left on device\n"), []), order(), FACTS)
    assert "nothing was changed: cp: No space left on device" in str(caught.value)
    assert not is_doubtful(caught.value)


def test_connection_that_breaks_while_it_is_told_leaves_doubt() -> None:
    assert is_doubtful(lost_connection("ros@bob.local", ""))
    assert not is_doubtful(AWAY)


def order() -> Order:
    return Order("abc", "pat@laptop", 60, GuardedChange(TITLE, (), ":", ":"))
