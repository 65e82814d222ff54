"""`ur robot rename`: another name for a robot."""

from __future__ import annotations

import getpass
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from ur.cli.changing import DRY_RUN, PASSWORD_FROM, WAIT, become_root, begin, finish, print_line, show_plan
from ur.cli.output import check_name, read_lines
from ur.robot.ssh.shell import LocalShell, run_process
from ur.source.diagnostic import UserError, user_error, user_error_about

if TYPE_CHECKING:
    from ur.robot.commit_confirm.guarded import GuardedChange
    from ur.robot.setup.facts import ComputerFacts
    from ur.robot.ssh.address import Address
    from ur.robot.ssh.openssh import SshShell
    from ur.robot.ssh.secret import Secret
    from ur.robot.ssh.shell import Shell

AWAY = ("unknown-host", "no-answer", "no-ssh")


@click.command("rename")
@click.argument("robot")
@click.argument("name", metavar="NEWNAME")
@WAIT
@PASSWORD_FROM
@DRY_RUN
def rename(robot: str, name: str, wait: int, password_from: int | None, dry_run: bool) -> int:
    """Rename a robot, and revert if it cannot be reached afterwards.

    The robot changes its name everywhere and waits for this computer to reconnect under the new one. If that does not
    happen, for example because a cable was pulled or this computer was switched off, the robot reverts the change; it
    also does so if it loses power meanwhile. Its boot services are restarted.
    """
    from ur.request.remote.connection import connect_robot, robot_address
    from ur.robot.ssh.address import Address

    check_name(name)
    address = robot_address(robot)
    later = Address(address.user, f"{name}.local")
    if later.host == address.host:
        raise user_error(f"the robot is already named '{robot}'", rule="bad-name", subject=robot)
    (password,) = read_lines(password_from, "--password-from", 1)
    try:
        with connect_robot(address) as shell:
            made = _begin(shell, name, password, wait, dry_run=dry_run)
    except UserError as problem:
        if problem.diagnostics[0].rule in AWAY and _is_there(later, address):
            remember(address.host.removesuffix(".local"), name)
            print_line(f"no computer answers to {address.host}, and {name} is there: nothing more to do")
            return 0
        raise
    if made is None:
        return 0
    from ur.robot.commit_confirm.perform import ChangeAddresses

    identity, change, facts, sudo = made
    finish(identity, change, ChangeAddresses((later,), address), wait, sudo, address.host)
    remember(facts.hostname, name)
    print_line(f"{facts.hostname} is called {name} now: ur shell {name}")
    print_line("what ran there already, and was not started at boot, keeps the old name until it is started anew")
    return 0


def _begin(
    shell: SshShell, name: str, password: str, wait: int, *, dry_run: bool
) -> tuple[str, GuardedChange, ComputerFacts, list[Secret]] | None:
    from ur.robot.commit_confirm.guarded import change_request, list_changes
    from ur.robot.commit_confirm.rename import plan_rename, rename_request
    from ur.robot.setup.engine import gather

    user = shell.address.user
    sudo = become_root(shell, password)
    base = rename_request(user)
    facts = gather(shell, base, root=True)
    change = plan_rename(facts, name)
    facts = gather(shell, base | change_request(change, user), root=True)
    if facts.hostname == name and not list_changes(change, facts):
        print_line(f"it is called {name} already, everywhere")
        return None
    _check_free(shell, LocalShell(), name, facts)
    if dry_run:
        show_plan(change, facts)
        return None
    return begin(shell, change, facts, wait), change, facts, sudo


def _check_free(there: Shell, here: Shell, name: str, facts: ComputerFacts) -> None:
    """Raise UserError if another computer answers to the name, for the robot or for this computer."""
    from concurrent.futures import ThreadPoolExecutor

    from ur.source.progress_line import show_progress

    print_line(f"looking whether {name}.local is free")
    with (
        show_progress(f"looking up {name}.local"),
        ThreadPoolExecutor(2) as pool,  # each waits seconds for an answer
    ):
        answers = list(pool.map(lambda shell: shell.run(f"getent ahostsv4 {name}.local").out, (there, here)))
    own = {*facts.addresses, "127.0.1.1"}
    others = {line.split()[0] for answer in answers for line in answer.splitlines() if line.strip()} - own
    if others:
        raise user_error(
            f"{name}.local is another computer already ({', '.join(sorted(others))}), expected a free name",
            rule="taken-name",
            help="choose another name, or rename that one",
            subject=name,
        )


def _is_there(later: Address, before: Address) -> bool:
    """Return whether a known robot has the new name, because an earlier run ended after its success.

    Raises UserError if that is undecided.
    """
    from ur.robot.commit_confirm.guard import BOOT_UNIT
    from ur.robot.commit_confirm.perform import open_as

    for known_as in (before.host, later.host):
        try:
            with open_as(known_as)(later) as link:
                done = link.run(f"cat /proc/sys/kernel/hostname; [ ! -e /etc/systemd/system/{BOOT_UNIT} ]")
        except UserError as problem:
            if problem.diagnostics[0].rule in AWAY:
                return False
            continue
        if done.code:
            raise user_error_about(
                later,
                "a change of its name is not finished, expected one at a time",
                rule="change-pending",
                help="it was not confirmed: the robot reverts it within two minutes; then run this again",
            )
        if done.out.strip() == later.host.removesuffix(".local"):
            return True
    return False


def remember(old: str, new: str) -> None:
    """Rename the robot in the records of this computer; a second call changes nothing."""
    from dataclasses import replace

    from ur.request.environment import current_selection
    from ur.robot.commit_confirm.rename import WantedKnownName
    from ur.robot.discovery.record import load_records, records_folder, render_record
    from ur.robot.selection import selection_path, store_selection
    from ur.robot.setup.engine import apply_states
    from ur.robot.setup.facts import FactsRequest
    from ur.robot.setup.wanted import Wanted, WantedFile

    host_key = _host_key((old, f"{old}.local", f"{new}.local"))
    folder = records_folder(os.environ)
    records = {record.name: record for record in load_records(folder)}
    record = records.get(old)

    def make(_: ComputerFacts) -> list[Wanted]:
        items: list[Wanted] = []
        if host_key:
            items.append(WantedKnownName(f"host key of {new}", old, new, host_key))
        if record:
            path = f"~/.config/ubiquity_launches/robots/{new}.yaml"
            items.append(WantedFile("memory of it", path, render_record(replace(record, name=new)), mode=0o600))
        return items

    user = getpass.getuser()
    apply_states(
        LocalShell(),
        make,
        user,
        FactsRequest(user),
        root=False,
        report=lambda change: print_line(f"here: {change.title}"),
    )
    if record:
        (folder / f"{old}.yaml").unlink(missing_ok=True)
    selected = current_selection(os.environ)
    if selected.robot == old:
        store_selection(selection_path(os.environ), selected._replace(robot=new))
        print_line(f"here: {new} is selected, as {old} was")


def _host_key(names: Sequence[str]) -> str | None:
    """Return the robot's public host key of the type that a set-up records, as known here under any of its names."""
    for name in names:
        done = run_process(["ssh-keygen", "-F", name], timeout=20, what="a known host key")
        for line in done.out.splitlines():
            fields = line.split()
            if len(fields) >= 3 and fields[1] == "ssh-ed25519":
                return " ".join(fields[1:3])
    return None
