from pathlib import Path

from ur.robot.doctor.findings import Finding, FixCommand
from ur.robot.doctor.inspect import ATTEMPTS, inspect_until_fixed, list_safe, run_fix
from ur.robot.ssh.shell import LocalShell

FIXABLE = Finding("clock", "the clock is wrong", commands=(FixCommand("local", "true", safe=True),))
OTHER = Finding("disk", "the disk is full", commands=(FixCommand("local", "rm -r x"),))


def test_only_safe_commands_are_run() -> None:
    assert list_safe([FIXABLE, OTHER]) == [("clock", FIXABLE.commands[0])]


def test_end_of_a_command_is_described(tmp_path: Path) -> None:
    shell, lock = LocalShell(), tmp_path / "state/doctor.lock"
    assert run_fix(FixCommand("local", "true"), shell, shell, lock) == "done"
    assert run_fix(FixCommand("remote", "echo one; echo no disk >&2; exit 3"), shell, shell, lock) == "failed: no disk"
    assert run_fix(FixCommand("local", "exit 3"), shell, shell, lock) == "failed: 3"


def test_computers_are_inspected_until_the_fixes_show() -> None:
    findings = iter([[FIXABLE, OTHER], [OTHER]])
    pauses: list[None] = []
    assert inspect_until_fixed([FIXABLE, OTHER], lambda: next(findings), lambda: pauses.append(None)) == [OTHER]
    assert len(pauses) == 1


def test_fix_that_does_not_help_is_reported_in_the_end() -> None:
    pauses: list[None] = []
    assert inspect_until_fixed([FIXABLE], lambda: [FIXABLE], lambda: pauses.append(None)) == [FIXABLE]
    assert len(pauses) == ATTEMPTS - 1
