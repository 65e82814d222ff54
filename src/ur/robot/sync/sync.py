"""A sync: inspect both sides, compare, transfer with rsync, move files into place, store the new state."""

import base64
import fcntl
import getpass
import os
import socket
import subprocess
import sys
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from ur.robot.ssh.failures import lost_connection
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote
from ur.robot.sync import side as side_program
from ur.robot.sync.compare import agree, drop_ignored
from ur.robot.sync.steps import (
    SIDES,
    File,
    Manifest,
    Side,
    SyncMemory,
    SyncPlan,
    WorkspacePair,
    check_path,
    known_files,
)
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.foreign.json_values import read_json_names, write_json_names


def workspace_path(path: str, root: Path) -> str:
    """Return a PATH relative to the workspace, '' for all of it.

    A relative path begins at the current folder if that lies in the workspace.
    """
    real = root.resolve()
    here = Path.cwd()
    base = here if here.is_relative_to(real) else real
    whole = Path(os.path.normpath(base / Path(path).expanduser()))
    for top in (real, root):
        if whole.is_relative_to(top):
            relative = str(whole.relative_to(top))
            return "" if relative == "." else relative
    raise refuse_sync(f"{path} is not in {root}", "name paths of the workspace")


def check_paths(paths: Mapping[str, str], known: Collection[str], root: Path, robot: str) -> None:
    """Raise UserError for a path, as the user typed it, that exists on neither computer."""
    for typed, path in paths.items():
        if path and path not in known and not any(each.startswith(f"{path}/") for each in known):
            raise refuse_sync(f"{typed}: nothing of this name is in {root}, here or on {robot}", "ur sync --dry-run")


def name_this_computer(robot: str) -> str:
    """Return the name under which this computer keeps files that a sync with a robot replaces."""
    # One folder per robot, since several may be synced at once.
    return f"{socket.gethostname().split('.')[0]}-{getpass.getuser()}-{robot}"


@contextmanager
def lock_sync(path: Path) -> Iterator[None]:
    """Lock out a second sync with the same robot from this computer. Raises UserError."""
    place = path.with_suffix(".lock")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        lock = place.open("w")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise refuse_sync(f"{place}: {reason}", "fix that and run this again") from None
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise refuse_sync("another sync with this robot is running", "wait for it, then run this again") from None
        yield


def refuse_sync(message: str, help: str) -> UserError:
    """Return the error of a sync that cannot be done."""
    return user_error(message, rule="no-sync", help=help)


WORKSPACE = "catkin_ws/src"
_LONGEST = 256 << 20  # characters of an answer
_SECONDS = 1800.0  # the first listing reads every file
_RSYNC_LOST = {10, 12, 30, 35, 255}  # rsync(1), exit values: socket I/O, protocol stream, two timeouts; and ssh's own


@dataclass(frozen=True, slots=True)
class SyncSide:
    """One side: its workspace, and the shell to run commands on it. `shell` is None for this computer."""

    side: Side
    shell: Shell | None


@dataclass(frozen=True, slots=True)
class WorkspaceContents:
    """The content of both sides without ignored files; the pair, and its state at the last sync."""

    here: Manifest
    there: Manifest
    pair: WorkspacePair
    last: SyncMemory | None


@dataclass(frozen=True, slots=True)
class SyncOutcome:
    """The result of a sync: the state for the next one, and the unchanged paths with the reasons, by side."""

    memory: SyncMemory
    left: Mapping[Side, Mapping[str, str]]


@dataclass(frozen=True, slots=True)
class _Scan:
    """The workspace of a side, as that side reports it."""

    files: Mapping[str, File]
    skipped: Mapping[str, str]
    root: str
    machine: str
    rsync: bool
    ignore: tuple[str, ...]

    @property
    def paths(self) -> Sequence[str]:
        """The paths of the scan, for `_ask` to check; '' is the workspace itself."""
        return [*self.files, *filter(None, self.skipped)]


@dataclass(frozen=True, slots=True)
class _Applied:
    """The files of a side after its steps, None for deleted ones, and the unchanged paths."""

    done: Mapping[str, File | None]
    left: Mapping[str, str]

    @property
    def paths(self) -> Sequence[str]:
        """The paths of the answer, for `_ask` to check."""
        return [*self.done, *filter(None, self.left)]


@dataclass(frozen=True, slots=True)
class _Prepared:
    """The answer of a side that has created its folders."""

    paths: tuple[str, ...] = ()


Answer = TypeVar("Answer", _Scan, _Applied, _Prepared)


def list_workspaces(shell: SshShell, root: Path, last: SyncMemory | None) -> WorkspaceContents:
    """List both workspaces. Raises UserError."""
    agreed = last.agreed if last else {}
    answers = {}
    for place, where in ((SyncSide("here", None), str(root)), (SyncSide("there", shell), f"~/{WORKSPACE}")):
        request = {"do": "scan", "root": where, "ignore": [], "known": known_files(agreed, place.side)}
        answers[place.side] = _ask(place, request, _Scan)
        if not answers[place.side].rsync:
            who = "this computer" if place.side == "here" else shell.destination
            raise user_error_about(
                who, "rsync is not installed", rule="missing-program", help="there: sudo apt-get install rsync"
            )
    patterns = [*answers["here"].ignore, *answers["there"].ignore]
    sides = [drop_ignored(Manifest(answers[side].files, answers[side].skipped), patterns) for side in SIDES]
    pair = WorkspacePair(answers["here"].root, answers["there"].root, answers["there"].machine)
    return WorkspaceContents(sides[0], sides[1], pair, last if last and last.pair == pair else None)


def carry_out(
    plan: SyncPlan,
    pair: WorkspacePair,
    shell: SshShell,
    *,
    name: str,
    stamp: str,
    progress: bool,
    report: Callable[[str], None],
) -> SyncOutcome:
    """Execute a plan's steps. `name` marks this viewer's arriving files; `stamp` names the folder of kept ones.

    After an interruption at any point, every file is either in its old or in its new state. Raises UserError if the
    connection breaks.
    """
    roots = {"here": pair.here, "there": pair.there}
    places = {"here": SyncSide("here", None), "there": SyncSide("there", shell)}
    done: dict[Side, Mapping[str, File | None]] = {"here": {}, "there": {}}
    left: dict[Side, Mapping[str, str]] = {"here": {}, "there": {}}
    for side in ("there", "here"):
        steps = [step for step in plan.steps if step.to == side]
        if not steps:
            continue
        beside = Path(roots[side]).parent / ".ur_sync"
        request = {"root": roots[side], "arriving": f"{beside}/arriving-{name}", "kept": f"{beside}/kept/{stamp}"}
        _ask(places[side], {**request, "do": "prepare"}, _Prepared)
        paths = [step.path for step in steps if step.after and step.after.kind == "file"]
        if paths:
            count = f"{len(paths)} file{'' if len(paths) == 1 else 's'}"
            report(f"{count} to {'this computer' if side == 'here' else shell.destination} ...")
            _run_rsync(shell, side, roots, request["arriving"], paths, progress=progress)
        rows = [(step.path, step.before, step.after, step.keep) for step in steps]
        answer = _ask(places[side], {**request, "do": "apply", "steps": rows}, _Applied)
        done[side], left[side] = answer.done, answer.left
    return SyncOutcome(SyncMemory(pair, agree(plan, done)), left)


def _ask(place: SyncSide, request: Mapping[str, object], kind: type[Answer]) -> Answer:
    """Send a request to a side and parse its answer, whose paths must be inside of the workspace. Raises UserError."""
    text = write_json_names(request)
    if place.shell is None:
        done, out = None, side_program.respond(text)
    else:
        source = base64.b64encode(zlib.compress(Path(side_program.__file__).read_bytes())).decode()
        code = f"import base64,zlib;exec(zlib.decompress(base64.b64decode('{source}')))"
        done = place.shell.run(quote("python3", "-I", "-c", code), stdin=text, timeout=_SECONDS)
        out = done.out
    try:
        answer = read_json_names(out, kind, _LONGEST)
        for path in answer.paths:
            check_path(path)
    except ValueError as problem:
        reasons = [f"exit code {done.code}" if done and done.code else str(problem)]
        reasons += done.err.strip().splitlines() if done else []
        message = f"its workspace cannot be read: {reasons[-1]}"
        who = place.shell.destination if place.shell else "this computer"
        raise user_error_about(who, message, rule="failed-sync", help="ur doctor") from None
    return answer


def rsync_command(
    ssh: Sequence[str], address: str, to: Side, roots: Mapping[str, str], arriving: str, *, progress: bool
) -> list[str]:
    """Return the rsync command for files, named on standard input, into a folder beside the workspace of side `to`.

    Partial files of an interrupted transfer, and the files to be replaced, are the basis of the delta transfer.
    """
    source = f"{roots['there' if to == 'here' else 'here']}/"
    target = f"{arriving}/"
    if to == "there":
        target = f"{address}:{target}"
    else:
        source = f"{address}:{source}"
    options = [
        *("--times", "--ignore-times", "--from0", "--files-from=-", "--no-implied-dirs", "--protect-args"),
        *("--partial-dir=.ur_partial", f"--copy-dest={roots[to]}", "--timeout=60"),
        *(["--info=progress2", "--no-inc-recursive"] if progress else []),
    ]
    return ["rsync", *options, "-e", quote(*ssh), "--", source, target]


def _run_rsync(
    shell: SshShell, to: Side, roots: Mapping[str, str], arriving: str, paths: Sequence[str], *, progress: bool
) -> None:
    host = f"[{shell.address.host}]" if ":" in shell.address.host else shell.address.host
    command = rsync_command(shell.words, f"{shell.address.user}@{host}", to, roots, arriving, progress=progress)
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=None if progress else subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        try:
            _, reported = process.communicate("\0".join(paths).encode(errors="surrogateescape"))
        except BaseException:
            process.terminate()
            raise
    if process.returncode in _RSYNC_LOST:
        raise lost_connection(shell.destination, reported.decode(errors="replace"))
    # 23 and 24: some files changed or vanished meanwhile. `apply` then reports them as incomplete.
    if process.returncode not in (0, 23, 24):
        lines = reported.decode(errors="replace").strip().splitlines() or [f"exit code {process.returncode}"]
        raise user_error_about(shell.destination, f"rsync: {lines[0]}", rule="failed-sync", help="ur doctor")
    sys.stdout.flush()
