"""A guarded change as a value: the desired files, and the scripts that apply them to the running robot. Pure."""

import base64
import io
import tarfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ur.robot.commit_confirm.guard import FOLDER
from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.wanted import Wanted
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import quote


@dataclass(frozen=True, slots=True)
class GuardedChange:
    """A change that the robot applies as a whole and reverts as a whole.

    `wanted`: the files that change. `also_kept`: absolute paths of files and folders that `live` modifies; those in
    /run are not restored after a boot. `live` applies the new files to the running system; if it fails, everything is
    reverted. `back` applies the restored files; `early` does so during boot, before the network starts. The scripts run
    as root and contain no secrets. `commit` makes a confirmed change permanent, in the folder of the change, where
    `step0` is the first script of `wanted` and `step0.in` its input; it is repeated until it succeeds. `words` describe
    the effect of `live`.
    """

    title: str
    wanted: tuple[Wanted, ...]
    live: str
    back: str
    early: str = ":"
    commit: str = ":"
    also_kept: tuple[str, ...] = ()
    words: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Order:
    """A change as it is sent to a robot: `identity` names this attempt, `who` requested it, `wait` is in seconds."""

    identity: str
    who: str
    wait: int
    change: GuardedChange


def list_changes(change: GuardedChange, facts: ComputerFacts) -> list[Change]:
    """List the changes on the robot, for display and for `pack_order`."""
    return [planned for item in change.wanted if (planned := item.plan(facts))]


def list_kept(change: GuardedChange, facts: ComputerFacts) -> list[str]:
    """Return the absolute paths of the files and folders that a revert restores."""
    requests = [item.request(facts.user) for item in change.wanted]
    paths = {path for request in requests for path in request.files}
    return [*sorted(facts.resolve(path) for path in paths), *change.also_kept]


def change_request(change: GuardedChange, user: str) -> FactsRequest:
    """Return the facts that `list_changes` needs."""
    request = FactsRequest(user)
    for item in change.wanted:
        request |= item.request(user)
    return request


def pack_order(order: Order, facts: ComputerFacts) -> Secret:
    """Pack all data for the robot into a tar archive in base64: a secret, since a new file may hold a password."""
    commands = [command for change in list_changes(order.change, facts) for command in change.commands]
    texts = {
        "id": f"{order.identity}\n",
        "title": f"{order.change.title}\n",
        "who": f"{order.who}\n",
        "wait": f"{order.wait}\n",
        "keeps": "".join(f"{path}\n" for path in list_kept(order.change, facts)),
        "apply": apply_script(commands, facts),
        "live": order.change.live + "\n",
        "back": order.change.back + "\n",
        "early": order.change.early + "\n",
        "commit": order.change.commit + "\n",
        **dict(_steps(commands)),
        "open": "",
        "end": "",  # last: without it the archive is incomplete
    }
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as archive:
        for name, text in texts.items():
            content = text.encode(errors="surrogateescape")
            member = tarfile.TarInfo(name)
            member.size, member.mode = len(content), 0o600
            archive.addfile(member, io.BytesIO(content))
    return Secret(base64.encodebytes(buffer.getvalue()).decode())


def apply_script(commands: Sequence[ChangeScript], facts: ComputerFacts) -> str:
    """Return the script by which the guard applies the change; it stops at the first command that fails."""
    lines = ["set -e", f"cd {FOLDER}/pending"]
    for number, command in enumerate(commands):
        # A user may not enter the folder, so the script is an argument, which holds no secret; standard input stays
        # free.
        own = f'runuser -u {quote(facts.user)} -- env HOME={quote(facts.home)} sh -c "$(cat step{number})"'
        lines.append(f"{f'sh step{number}' if command.root else own} <step{number}.in")
    return "\n".join([*lines, "sh live", ""])


def _steps(commands: Sequence[ChangeScript]) -> Iterator[tuple[str, str]]:
    for number, command in enumerate(commands):
        yield f"step{number}", command.script + "\n"
        given = command.stdin
        yield f"step{number}.in", given.reveal() if isinstance(given, Secret) else given
