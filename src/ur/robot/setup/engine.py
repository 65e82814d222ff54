"""Engine of the set-up: gather facts, plan changes, apply them, and check the result."""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import reduce
from pathlib import Path

import ur.system
from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest, fact_script, parse_facts
from ur.robot.setup.made import RECORD
from ur.robot.setup.wanted import Wanted
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, user_error_about

MOST_CHANGES = 300  # rounds of one set-up, which has some dozens: a computer whose facts differ each time ends it
Make = Callable[[ComputerFacts], Sequence[Wanted]]
Progress = Callable[[str, float, str], None]
LOOK_SECONDS = 2.0
_MOST_DIGITS = 16  # of the size of a log
_PROGRESS = Path(ur.system.__path__[0], "progress.awk")
# The proxy is read from standard input, since it contains a password.
_READ_ROUTE = """\
IFS= read -r proxy; IFS= read -r direct
[ -z "$proxy" ] || export http_proxy="$proxy" https_proxy="$proxy" no_proxy="$direct"
"""


def no_proxy() -> Secret:
    """Return the two lines that a command which downloads packages reads first: no proxy, and no exceptions."""
    return Secret("\n\n")


def gather(shell: Shell, request: FactsRequest, *, root: bool = False) -> ComputerFacts:
    """Gather facts about a computer in one round trip. `root` allows to read files that only root may read."""
    done = shell.run(fact_script(request), root=root)
    return parse_facts(request, done.out)


def gather_facts(shell: Shell, wanted: Sequence[Wanted], user: str, base: FactsRequest, *, root: bool) -> ComputerFacts:
    """Gather the facts that these wanted states need, and those of `base`."""
    return gather(shell, reduce(FactsRequest.__or__, [item.request(user) for item in wanted], base), root=root)


def plan_changes(wanted: Sequence[Wanted], facts: ComputerFacts) -> list[Change]:
    """Plan the changes, in order; empty if the computer is in the wanted state."""
    return [change for item in wanted if (change := item.plan(facts))]


def plan_together(wanted: Sequence[Wanted], facts: ComputerFacts, user: str, base: FactsRequest) -> list[Change]:
    """Plan the first changes, in order, that need no new facts in between.

    The list ends before a change that depends on a file which an earlier one modifies, and after one that modifies many
    files, as packages do, or a fact in `base`, on which the wanted states themselves depend.
    """
    changes: list[Change] = []
    changed: set[str] = set()
    for item in wanted:
        change = item.plan(facts)
        if change is None:
            continue
        request = item.request(user)
        paths = request.files - {RECORD}
        if any(_overlap(path, other) for path in paths for other in changed):
            break
        changes.append(change)
        changed |= paths
        fetches = any(command.fetches for command in change.commands)
        if request.packages or fetches or any(_overlap(path, other) for path in paths for other in base.files):
            break
    return changes


def _overlap(path: str, other: str) -> bool:
    """Return whether the paths are equal, or one of them is a parent folder of the other."""
    return path == other or path.startswith(f"{other}/") or other.startswith(f"{path}/")


def plan_undo(wanted: Sequence[Wanted], facts: ComputerFacts) -> list[Change]:
    """Plan the changes that undo everything, last first."""
    return [change for item in reversed(wanted) if (change := item.undo(facts))]


def apply_change(
    shell: Shell,
    change: Change,
    *,
    route: Callable[[], Secret] = no_proxy,
    progress: Progress | None = None,
    pause: float = LOOK_SECONDS,
) -> None:
    """Run a change's commands. Raises UserError, which names the command that failed and its output.

    `route` gives the proxy of commands that fetch packages; `progress` is called every `pause` s with a change's title,
    its duration so far (s) and the last line of its log.
    """
    for command in change.commands:
        script, stdin = command.script, command.stdin
        if command.fetches:
            text = stdin.reveal() if isinstance(stdin, Secret) else stdin
            script, stdin = _READ_ROUTE + script, Secret(route().reveal() + text)
        with _follow_log(shell, change, command, progress, pause):
            done = shell.run(script, root=command.root, stdin=stdin, timeout=command.timeout)
        if done.code:
            reported = (done.err or done.out).strip().splitlines()
            reason = reported[0] if reported else f"exit code {done.code}"
            raise user_error_about(
                shell.destination,
                f"{change.title}: {reason}",
                rule="failed-change",
                help="fix that and run this again: it continues where it stopped",
            )


def apply_states(
    shell: Shell,
    make: Make,
    user: str,
    base: FactsRequest,
    *,
    root: bool,
    report: Callable[[Change], None],
    route: Callable[[], Secret] = no_proxy,
    progress: Progress | None = None,
    ask: Callable[[Shell, FactsRequest, bool], ComputerFacts] = lambda shell, request, root: gather(
        shell, request, root=root
    ),
) -> tuple[ComputerFacts, int]:
    """Bring a computer to the wanted state; return its facts afterwards, and the number of changes.

    `make` returns the wanted states for the facts of `base`; `report` is called before each change. Changes are applied
    in order. Facts are gathered again, by `ask`, before a change that an earlier one may affect, and at the end. Raises
    UserError if a change fails or has no lasting effect.
    """
    made: list[Change] = []
    asked = base
    while len(made) < MOST_CHANGES:
        facts = ask(shell, asked, root)
        wanted = make(facts)
        needed = reduce(FactsRequest.__or__, [item.request(user) for item in wanted], base)
        if not asked.covers(needed):
            asked = needed
            facts = ask(shell, asked, root)
        changes = plan_together(wanted, facts, user, base)
        if not changes:
            if made:  # sync to the disk, so that enabled and removed files last
                shell.run('sync -f / /etc /var "$HOME" 2>/dev/null || sync')
            return facts, len(made)
        for change in changes:
            if change in made:
                raise user_error_about(
                    shell.destination,
                    f"{change.title}: changed, and still not as wanted",
                    rule="failed-change",
                    help="look at its log there (journalctl), then run this again",
                )
            report(change)
            apply_change(shell, change, route=route, progress=progress)
            made.append(change)
    raise user_error_about(
        shell.destination,
        f"{MOST_CHANGES} changes were made, and it is still not as wanted",
        rule="failed-change",
        help="each check of it finds another state: ur doctor",
    )


@contextmanager
def _follow_log(
    shell: Shell, change: Change, command: ChangeScript, progress: Progress | None, pause: float
) -> Iterator[None]:
    """Report the progress of a command while the context lasts: what it appends to its log, or its last line."""
    if progress is None or not command.log:
        yield
        return
    show, begin, done = progress, time.monotonic(), threading.Event()
    log = quote(command.log)
    size = shell.run(f"wc -c <{log} 2>/dev/null", timeout=10.0).out.strip()
    # The text is that of another computer
    begins = int(size) + 1 if size.isdecimal() and len(size) < _MOST_DIGITS else 1
    script = f"tail -c +{begins} {log} 2>/dev/null | awk {quote(_PROGRESS.read_text('utf-8'))}"

    def follow() -> None:
        while not done.wait(pause):
            try:
                line = shell.run(script, timeout=10.0).out.strip()
            except UserError:
                continue  # the connection has ended: the command itself reports that
            if line and not done.is_set():
                show(change.title, time.monotonic() - begin, line)

    follower = threading.Thread(target=follow, name="progress", daemon=True)
    follower.start()
    try:
        yield
    finally:
        done.set()
        follower.join()
