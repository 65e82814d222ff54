"""Runs on this computer: one private folder each, with a description and the control socket."""

from __future__ import annotations

import json
import os
import socket
import stat
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, Origin, Plan
from ur.source.data_classes import dataclass, field, replace
from ur.source.diagnostic import user_error, user_error_about
from ur.source.foreign.files import read_text
from ur.source.replace import replace_file
from ur.source.run_users import read_birth
from ur.source.suggest import did_you_mean
from ur.source.user_folders import user_folder

SHARED = "/tmp"  # noqa: S108 - what is in it is used only if it is private


@dataclass(frozen=True, slots=True)
class RunEntry:
    """A run: `born` is the start of its process in clock ticks since boot `boot`, to detect a reused process id.

    `run` is its id, `title` the launch file, `started` in s since the epoch, `folder` its control folder. It belongs to
    the computer `machine` (see `ur.run.record.registry`); `host` is the name of this computer when the run started.
    Entries of earlier versions have neither `machine` nor `boot`.
    """

    run: str
    pid: int
    born: int
    title: str
    master_uri: str
    log_folder: str
    started: float
    detached: bool
    host: str
    folder: str = ""
    machine: str = ""
    boot: str = ""


def runs_folders(environment: Mapping[str, str], uid: int) -> list[str]:
    """Return registry folders of a user's runs, best first.

    The session's runtime folder is not first: logout deletes it.
    """
    found = [f"{user_folder('XDG_STATE_HOME', environment)}/ur/runs"]
    runtime = environment.get("XDG_RUNTIME_DIR", "")
    found.append(f"{runtime}/ur/runs" if runtime.startswith("/") else f"{SHARED}/ur-{uid}/runs")
    return found


def is_own(entry: RunEntry, computer: Computer) -> bool:
    """Return whether a run belongs to this computer, even if the computer had another name when the run started."""
    return entry.machine == computer.machine if entry.machine else entry.host == computer.host


_MACHINE_ID = "/etc/machine-id"
_BOOT_ID = "/proc/sys/kernel/random/boot_id"


@dataclass(frozen=True, slots=True)
class Computer:
    """A computer: `machine` is its machine-id(5), or its host name where it has none; `boot` is '' if unknown.

    The machine-id is confidential: it stays on the computer.
    """

    machine: str
    boot: str
    host: str


def read_computer(machine_id: str = _MACHINE_ID, boot_id: str = _BOOT_ID) -> Computer:
    """Read the identity of this computer."""
    host = socket.gethostname()
    machine = _read_line(machine_id)
    if machine in ("", "uninitialized"):  # before the first boot has finished, machine-id(5)
        machine = host
    return Computer(machine, _read_line(boot_id), host)


def describe_user(computer: Computer, uid: int) -> str:
    """Return the identity of a user of a computer for other computers, from which the machine-id cannot be computed."""
    from hashlib import sha256

    return sha256(f"ubiquity_launches\0{computer.machine}\0{uid}".encode()).hexdigest()[:32]


def _read_line(path: str) -> str:
    try:
        with open(path, encoding="ascii", errors="replace") as file:  # noqa: PTH123 - pathlib is slow to import
            return file.readline(256).strip()
    except OSError:
        return ""


SOCKET = "control"
DESCRIPTION = "run.json"
MOST_CHARACTERS = 100_000
_LATEST = 1e12  # s since the epoch; calculations with later times fail


def register_run(entry: RunEntry, environment: Mapping[str, str], uid: int) -> tuple[RunEntry, socket.socket] | None:
    """Create the folder of a run and listen on its socket; None if no folder can be written.

    Without it no client can connect.
    """
    for root in runs_folders(environment, uid):
        folder = f"{root}/{entry.run}"
        try:
            _make_private(root)
            if not _is_private(root, uid):
                continue
            os.mkdir(folder, 0o700)  # noqa: PTH102 - likewise
            listener = _listen(folder)
            made = replace(entry, folder=folder)
            with open(f"{folder}/{DESCRIPTION}.new", "wb") as file:  # noqa: PTH123 - likewise
                file.write(encode(made))
            os.rename(f"{folder}/{DESCRIPTION}.new", f"{folder}/{DESCRIPTION}")  # noqa: PTH104 - likewise
        except OSError:
            _remove_folder(folder)
            continue
        return made, listener
    return None


def encode(value: object) -> bytes:
    """Encode a value of data classes as JSON. What is not UTF-8 becomes '?'."""
    fields = json.dumps(value, ensure_ascii=False, default=lambda each: {n: getattr(each, n) for n in each.__slots__})
    return fields.encode("utf-8", "replace")


def unregister_run(entry: RunEntry) -> None:
    """Remove the folder of a run."""
    if entry.folder:
        _remove_folder(entry.folder)


def list_runs(environment: Mapping[str, str], uid: int, computer: Computer) -> list[RunEntry]:
    """Return the active runs on this computer, oldest first. Killed runs become ended ones."""
    found = []
    for root in runs_folders(environment, uid):
        try:
            names = sorted(os.listdir(root)) if _is_private(root, uid) else []  # noqa: PTH208 - likewise
        except OSError:
            continue
        for name in names:
            entry = _read_entry(f"{root}/{name}")
            if entry is None:
                pid = name.rpartition(".")[2]
                if pid.isdigit() and read_birth(int(pid)) is None:  # whose run has died
                    _remove_folder(f"{root}/{name}")
                continue
            if not is_own(entry, computer):
                continue  # of another computer with the same home folder
            if is_alive(entry, computer):
                found.append(entry)
            else:
                write_killed(entry, environment, uid)
                unregister_run(entry)
    return sorted(found, key=lambda entry: entry.started)


def is_alive(entry: RunEntry, computer: Computer) -> bool:
    """Return whether the supervisor of a run of this computer is still running."""
    return entry.boot in ("", computer.boot) and read_birth(entry.pid) == entry.born


def find_run(runs: Iterable[RunEntry], word: str | None) -> RunEntry:
    """Find the run with this id, prefix of an id, or launch file; without `word`, the only run.

    Raises UserError if there is no run, or none or several match.
    """
    runs = list(runs)
    if not runs:
        raise user_error("no run is active", rule="no-run", help="start one: ur launch --detach FILE")
    matching = [run for run in runs if word is None or run.run == word or run.title == word]
    if not matching and word is not None:
        matching = [run for run in runs if run.run.startswith(word)]
    if len(matching) == 1:
        return matching[0]
    names = ", ".join(run.run for run in (matching or runs))
    if matching:
        what = "several runs" if word is None else f"{word!r} is the name of several runs"
        raise user_error_about(what, f"{names}, expected one of them", rule="several-runs", help="ur ps lists them")
    near = did_you_mean(str(word), [run.run for run in runs] + [run.title for run in runs])
    raise user_error(
        f"run {word!r} is not there, expected one of {names}",
        rule="unknown-run",
        help=f"did you mean {near!r}?" if near else "ur ps lists them",
        subject=str(word),
    )


def make_run_name(files: Iterable[str], pid: int) -> tuple[str, str]:
    """Return a run's title and id: the name of its first launch file, and that with the process id."""
    first = next(iter(files), "run").rpartition("/")[2]
    title = first.removesuffix(".xml").removesuffix(".launch") or "run"
    safe = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in title)[:60]
    return title, f"{safe}.{pid}"


def _listen(folder: str) -> socket.socket:
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    place = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        listener.bind(f"/proc/self/fd/{place}/{SOCKET}")  # a socket's address holds 107 bytes only, unix(7)
    finally:
        os.close(place)
    listener.listen(8)
    listener.setblocking(False)
    return listener


def _make_private(root: str) -> None:
    above = os.path.dirname(root)  # noqa: PTH120 - likewise
    if not os.path.lexists(above):
        os.makedirs(os.path.dirname(above), exist_ok=True)  # noqa: PTH103, PTH120 - likewise
        os.mkdir(above, 0o700)  # noqa: PTH102 - likewise
    if not os.path.lexists(root):
        os.mkdir(root, 0o700)  # noqa: PTH102 - likewise


def _is_private(root: str, uid: int) -> bool:
    # The owner of the parent folder, and every user who may write to it, can replace this folder at any time; in
    # /tmp that may be any user. A group may be the user's own.
    for folder, open_to in ((os.path.dirname(root), 0o002), (root, 0o022)):  # noqa: PTH120 - likewise
        status = os.lstat(folder)
        if not stat.S_ISDIR(status.st_mode) or status.st_uid != uid or status.st_mode & open_to:
            return False
    return True


def _read_entry(folder: str) -> RunEntry | None:
    from ur.source.foreign.json_values import convert_json, read_json

    try:
        # A FIFO in its place would block; other special files have no description.
        descriptor = os.open(f"{folder}/{DESCRIPTION}", os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        with open(descriptor, "rb") as file:  # noqa: PTH123 - likewise
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                return None
            found = read_json(file.read(MOST_CHARACTERS), dict)
        entry = convert_json(found, RunEntry)
    except (OSError, ValueError):
        return None
    known = set(found).issubset(RunEntry.__slots__)
    return replace(entry, folder=folder) if known and 0 <= entry.started < _LATEST else None


def _remove_folder(folder: str) -> None:
    import shutil  # with every compression, which a run does not keep in memory

    shutil.rmtree(folder, ignore_errors=True)


_LONGEST = 2000  # characters of a value
_MOST_BYTES = 8_000_000


def plan_path(log_folder: str, run: str) -> Path:
    """The file of a run's plan."""
    return Path(log_folder, f"{run}.plan.json")


def write_plan(path: Path, plan: Plan, nodes: Sequence[NodeSpec], arguments: Sequence[str]) -> None:
    """Write the plan of a run, for its user only. Raises OSError."""
    values = {
        "arguments": list(arguments),
        "files": list(plan.files),
        "nodes": {
            node.full_name: {
                "program": f"{node.package}/{node.type}",
                "arguments": node.args,
                "machine": node.machine or "",
                "written at": describe_origin(node.origin),
            }
            for node in nodes
        },
        "parameters": {each.name: str(each.value)[:_LONGEST] for each in plan.params},
        "origins": [f"{each.name} is written at {describe_origin(each.origin)}" for each in plan.params],
    }
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(descriptor, "w", encoding="utf-8", errors="replace") as file:
        json.dump(values, file, ensure_ascii=False)


def read_plan(path: Path) -> dict[str, object]:
    """The plan of a run; {} where there is none."""
    from ur.source.foreign.json_values import read_json

    try:
        found = read_json(read_text(path, _MOST_BYTES), dict[str, object])
    except (OSError, ValueError):
        return {}
    return found


def describe_origin(origin: Origin) -> str:
    """The place where something was written: file and line, then those of the includes."""
    return ", included at ".join(f"{span.file.path}:{span.position.line}" for span in (origin.span, *origin.includes))


MAX_RUNS = 50
MAX_LINES = 30
_MAX_BYTES = 1 << 18
_MAX_LINE = 500


@dataclass(frozen=True, slots=True)
class EndedRun:
    """A run that has ended.

    `ended` is in s since the epoch, `exit_code` None for one that was killed. `cause` is a text for the user, ''
    without one. `lines` are the last lines that the run itself printed; `logs` are the log files of its nodes by name.
    """

    entry: RunEntry
    ended: float
    exit_code: int | None
    cause: str = ""
    lines: tuple[str, ...] = ()
    logs: Mapping[str, str] = field(default_factory=dict)


def write_ended(run: EndedRun, environment: Mapping[str, str], uid: int) -> None:
    """Store an ended run, and remove the oldest beyond MAX_RUNS. No effect if the file cannot be written."""
    folder = _folder(environment, uid)
    lines = tuple(line[:_MAX_LINE] for line in run.lines[-MAX_LINES:])
    text = encode(replace(run, lines=lines))
    with suppress(OSError):
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(folder / f"{run.entry.run}.{int(run.entry.started)}.json", text, lasting=False)
        kept = sorted(folder.glob("*.json"), key=lambda path: path.stat().st_mtime)
        for path in kept[:-MAX_RUNS]:
            path.unlink(missing_ok=True)


def write_killed(entry: RunEntry, environment: Mapping[str, str], uid: int) -> None:
    """Store a run whose process was killed, with the content of its log file and the time of detection."""
    lines: tuple[str, ...] = ()
    with suppress(OSError), Path(entry.log_folder, f"{entry.run}.log").open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _MAX_BYTES))
        lines = tuple(file.read(_MAX_BYTES).decode("utf-8", "replace").splitlines()[-MAX_LINES:])
    write_ended(EndedRun(entry, time.time(), None, "its process was killed", lines), environment, uid)


def list_ended(environment: Mapping[str, str], uid: int, computer: Computer) -> list[EndedRun]:
    """Return the ended runs of a user on this computer, latest last."""
    found = [_read(path) for path in _folder(environment, uid).glob("*.json")]
    return sorted((run for run in found if run and is_own(run.entry, computer)), key=lambda run: run.ended)


def find_ended(runs: Collection[EndedRun], word: str | None) -> EndedRun | None:
    """Find the latest run with this id, prefix of an id, or launch file; without `word`, the latest of all."""
    for exact in (True, False):
        for run in reversed(list(runs)):
            names = (run.entry.run, run.entry.title)
            if word is None or (word in names if exact else run.entry.run.startswith(word)):
                return run
    return None


def _folder(environment: Mapping[str, str], uid: int) -> Path:
    return Path(runs_folders(environment, uid)[0]).parent / "ended"


def _read(path: Path) -> EndedRun | None:
    from ur.source.foreign.json_values import read_json

    try:
        with path.open("rb") as file:
            return read_json(file.read(_MAX_BYTES * 4), EndedRun)
    except (OSError, ValueError):
        return None
