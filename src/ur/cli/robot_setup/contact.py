"""First contact of `ur robot setup`: host keys confirmed by the user, and the robot's login to this computer."""

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import click

from ur.robot.discovery.record import load_records, records_folder
from ur.robot.setup.contact import COMPARE, OfferedHostKey, meet, needs_answer
from ur.robot.setup.login import Task
from ur.robot.ssh.host_key import parse_fingerprint
from ur.source.diagnostic import user_error_about


class SetupTerminal(Protocol):
    """Asks the user. `ask` and `confirm` may be called only if `is_there` returns true."""

    def is_there(self) -> bool:
        """Return whether a terminal is available for questions."""

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:
        """Ask for a text; an empty answer is the default, if there is one."""

    def confirm(self, question: str) -> bool:
        """Ask for yes or no; an empty answer is no."""


class OwnTerminal:
    """The terminal of this process. See SetupTerminal."""

    def is_there(self) -> bool:
        return sys.stdin.isatty()

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:
        answer: str = click.prompt(question, default=default, show_default=show_default)
        return answer

    def confirm(self, question: str) -> bool:
        return click.confirm(question, default=False)


TERMINAL = OwnTerminal()


def read_fingerprint(text: str) -> str:
    """Parse a fingerprint from the user. Raises UserError."""
    try:
        return parse_fingerprint(text)
    except ValueError as problem:
        raise user_error_about("--host-key", f"{problem}", rule="bad-value", help=f"to see it, {COMPARE}") from None


def confirm_host_key(
    task: Task,
    *,
    fingerprint: str = "",
    yes: bool = False,
    new_host_key: bool = False,
    terminal: SetupTerminal = TERMINAL,
    handshake: Callable[..., OfferedHostKey] = meet,
) -> Task:
    """Compare the robot's host key with the known one, and ask about a new one; return the task with the key.

    `fingerprint` was given by the user, `yes` confirms any key. No secret is sent. Raises UserError if the key differs,
    the user refuses it, or there is no terminal.
    """
    contact = handshake(task.address, task.later, with_key=bool(fingerprint))
    if needs_answer(task.address, contact, fingerprint=fingerprint, new_host_key=new_host_key):
        assert contact.host_key
        if yes:
            click.echo(f"{task.robot.name}: first contact, host key {contact.host_key.fingerprint}: accepted by --yes")
        else:
            _ask(task, contact, terminal)
    elif contact.is_first and contact.host_key:
        click.echo(f"{task.robot.name}: first contact, host key {contact.host_key.fingerprint}: as given")
    return replace(task, host_key=contact.pinned, first_contact=contact.is_first)


def _ask(task: Task, contact: OfferedHostKey, terminal: SetupTerminal) -> None:
    assert contact.host_key
    offered = contact.host_key.fingerprint
    was = "another one was known before" if contact.state == "changed" else "not known to this computer"
    if not terminal.is_there():
        raise user_error_about(
            task.address,
            f"its host key is {offered}, {was}, and there is no terminal to ask on",
            rule="unconfirmed-host-key",
            help=f"compare with the robot's own, {COMPARE}; then add --host-key {offered}, "
            "or --yes in a network that you trust",
        )
    click.echo(
        f"the host key of {task.address} is {was}:\n"
        f"  {offered}\n"
        f"  compare it with the robot's own, {COMPARE}\n"
        "  the computer with this key gets the passwords that you give"
    )
    while True:
        answer = terminal.ask("is it the robot's? [y/N, or the fingerprint]", "n", show_default=False).strip()
        if answer.lower() in ("y", "yes") or answer.rstrip("=") == offered:
            return
        if answer.lower() in ("n", "no") or answer.startswith("SHA256:"):
            raise user_error_about(
                task.address,
                "its host key is not confirmed, and nothing was sent to it",
                rule="unconfirmed-host-key",
                help="another computer may answer to this name: use the robot's address, or connect it by cable",
            )


def decide_robot_login(tasks: Sequence[Task], wanted: bool | None, terminal: SetupTerminal = TERMINAL) -> list[Task]:
    """Return the tasks with the decision whether the robots may log in to this computer.

    The decision is `wanted`, from an option; else the earlier one for a robot; else the user's answer, or, without a
    terminal, no.
    """
    before = {record.name: record.robot_login for record in load_records(records_folder(os.environ))}
    open_ = [task.robot.name for task in tasks if wanted is None and before.get(task.robot.name) is None]
    answer = bool(open_) and _ask_login(open_, terminal)
    return [replace(task, robot_login=_decide(task.robot.name, wanted, before, answer)) for task in tasks]


def _decide(name: str, wanted: bool | None, before: Mapping[str, bool | None], answer: bool) -> bool:
    if wanted is not None:
        return wanted
    known = before.get(name)
    return answer if known is None else known


def _ask_login(names: Sequence[str], terminal: SetupTerminal) -> bool:
    who = ", ".join(names)
    if not terminal.is_there():
        click.echo(f"{who}: may not log in to this computer; --robot-login allows it")
        return False
    click.echo(
        "roslaunch on a robot starts nodes on this computer by ssh; without that, the robot needs no login here, "
        "and ur needs none"
    )
    return terminal.confirm(f"may {who} log in to this computer by key?")
