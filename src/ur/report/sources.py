"""The content of a report besides the recording: logs, parameters, environment, versions, changes and load."""

import os
import platform
import re
import subprocess
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from importlib import metadata
from pathlib import Path

from ur.run.master.client import parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.record.registry import EndedRun, RunEntry, plan_path, read_plan
from ur.source.diagnostic import UserError
from ur.source.foreign.files import read_file, read_text
from ur.source.foreign.json_values import write_json

_MOST_CHANGES = 4_000_000  # bytes, with all lines of the files
_MOST_INDEX = 64_000_000
_LIMITS = ("timeout", "--signal=KILL", "2", "prlimit", f"--as={1 << 30}", "--")  # s, bytes
_FILE = re.compile(r"(?:---|\+\+\+) (?:[ab]/(.*)|/dev/null)")
_COMMIT = re.compile("[0-9a-f]{40}")
_POINTER = re.compile("(?:gitdir|ref): (.{1,4000})")


@dataclass(frozen=True, slots=True)
class WorkspaceChanges:
    """The commit and the differences as a text, and both versions of the files that differ, with their names."""

    text: str = ""
    versions: tuple[tuple[str, str], ...] = ()


def read_changes(folder: Path) -> WorkspaceChanges:
    """Return the changes of the repository that a folder is in; none without a repository, or if they are too many."""
    top = next((each for each in (folder, *folder.parents) if (each / ".git").exists()), None)
    try:
        with tempfile.TemporaryDirectory(prefix="ur_report_") as own:
            return WorkspaceChanges() if top is None else _read_changes(top.resolve(), Path(own))
    except (OSError, ValueError, subprocess.SubprocessError):
        return WorkspaceChanges()


def _read_changes(top: Path, own: Path) -> WorkspaceChanges:
    settings = top / ".git"
    if settings.is_file():  # of another work tree, or a submodule
        settings = top / _follow(read_text(settings, 4096).strip())
    shared = settings / "commondir"
    common = settings / read_text(shared, 4096).strip() if shared.exists() else settings
    commit = _find_commit(settings, common)
    for name in ("objects", "refs"):
        (own / name).mkdir()
    (own / "HEAD").write_text(commit)
    if (settings / "index").exists():
        (own / "index").write_bytes(read_file(settings / "index", _MOST_INDEX))
        written = (settings / "index").stat().st_mtime_ns  # by which git knows files that changed in the same moment
        os.utime(own / "index", ns=(written, written))
    environment = {
        "PATH": os.defpath,
        "LC_ALL": "C.UTF-8",
        "GIT_DIR": str(own),
        "GIT_WORK_TREE": str(top),
        "GIT_OBJECT_DIRECTORY": str(common / "objects"),
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_NOSYSTEM": "1",
        "GIT_ATTR_NOSYSTEM": "1",
        "GIT_NO_LAZY_FETCH": "1",
    }
    text, whole = (_run_git(environment, (context, "--stat", "--patch", commit)) for context in ("-U3", "-U1000000"))
    return WorkspaceChanges(f"commit {commit}\n\n{text}", tuple(_split_versions(whole)))


def _run_git(environment: dict[str, str], words: tuple[str, ...]) -> str:
    """Return what 'git diff' prints. Raises OSError where it fails, and for more than _MOST_CHANGES."""
    options = ("--no-ext-diff", "--no-textconv", "--no-color", "--no-renames", "--ignore-submodules=all")
    with subprocess.Popen(
        [*_LIMITS, "git", "diff", *options, *words],
        env=environment,
        cwd=environment["GIT_WORK_TREE"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as process:
        assert process.stdout is not None
        output = process.stdout.read(_MOST_CHANGES + 1)
        if len(output) > _MOST_CHANGES:
            process.kill()
    if process.returncode:
        raise OSError(f"git ended with exit code {process.returncode}")
    return output.decode("utf-8", "replace")


def _split_versions(whole: str) -> Iterator[tuple[str, str]]:
    """Yield the versions of files, each with its name, of differences with all lines around them."""
    for section in f"\n{whole}".split("\ndiff --git ")[1:]:
        head, _, body = section.partition("\n@@ ")
        names = [found[1] for line in head.splitlines() if (found := _FILE.fullmatch(line)) and found[1]]
        lines = body.splitlines()[1:]
        for sign in "-+":
            text = "".join(f"{line[1:]}\n" for line in lines if line[:1] in (sign, " "))
            yield names[-1] if names else "", text


def _find_commit(settings: Path, common: Path) -> str:
    """Return the commit of HEAD. Raises OSError, ValueError."""
    name = "HEAD"
    for _ in range(5):
        place = next((each / name for each in (settings, common) if (each / name).is_file()), None)
        if place is None:
            lines = (each.split(" ", 1) for each in read_text(common / "packed-refs").splitlines() if " " in each)
            text = next(commit for commit, known in lines if known == name)
        else:
            text = read_text(place, 4096).strip()
        if _COMMIT.fullmatch(text):
            return text
        name = _follow(text)
        if ".." in name.split("/") or not name.startswith("refs/"):
            raise ValueError(name)
    raise ValueError(name)


def _follow(text: str) -> str:
    found = _POINTER.fullmatch(text)
    if found is None:
        raise ValueError(text)
    return found[1]


_MOST_LOG = 1_000_000  # bytes from the end of a log
_MOST_LOGS = 8_000_000  # of all logs
_WITHIN = 1.0  # s for a master
_STAMP = re.compile(r"(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d)[,.](\d{3})")
_NAMES = re.compile(
    r"(ROS|UR|AMENT|COLCON|CMAKE|PYTHON|RMW|CYCLONEDDS|FASTRTPS|XDG|LANG|DISPLAY|TERM|PATH|HOME|USER)\w*"
)


@dataclass(frozen=True, slots=True)
class RunSources:
    """Texts by the names of their files, and trees of values by the name of theirs.

    `versions` are names and texts of changed files, whose secrets the archive may repeat.
    """

    texts: dict[str, str] = field(default_factory=dict)
    values: dict[str, object] = field(default_factory=dict)
    versions: tuple[tuple[str, str], ...] = ()


def collect(entry: RunEntry, ended: EndedRun | None, environment: Mapping[str, str]) -> RunSources:
    """Collect what is known of a run; what cannot be read is left out."""
    plan = read_plan(plan_path(entry.log_folder, entry.run))
    files = plan.get("files")
    changes = WorkspaceChanges()
    if isinstance(files, list) and files and isinstance(files[0], str) and Path(files[0]).is_absolute():
        changes = read_changes(Path(files[0]).parent)
    texts = read_logs(Path(entry.log_folder))
    texts["logs/all.txt"] = merge_logs(texts)
    if changes.text:
        texts["workspace.diff"] = changes.text
    run: dict[str, object] = {
        "run": entry.run,
        "launch file": entry.title,
        "started": _clock(entry.started),
        "computer": entry.host,
        "master": entry.master_uri,
    }
    if ended is not None:
        run |= {"ended": _clock(ended.ended), "exit code": ended.exit_code, "cause": ended.cause}
        texts["last_lines.txt"] = "\n".join(ended.lines) + "\n"
    values: dict[str, object] = {
        "run.json": run,
        "plan.json": plan,
        "parameters.json": read_parameters(entry.master_uri) if ended is None else {},
        "environment.json": {name: value for name, value in sorted(environment.items()) if _NAMES.match(name)},
        "versions.json": read_versions(),
        "system.json": read_system(),
    }
    return RunSources(texts, values, changes.versions)


def read_logs(folder: Path) -> dict[str, str]:
    """The ends of the log files of a run, newest first, as far as they are small enough together."""
    found: dict[str, str] = {}
    left = _MOST_LOGS
    with suppress(OSError):
        files = [path for path in folder.iterdir() if path.suffix == ".log" and path.is_file()]
        for path in sorted(files, key=lambda each: each.stat().st_mtime, reverse=True):
            with suppress(OSError), path.open("rb") as file:
                size = file.seek(0, os.SEEK_END)
                file.seek(max(0, size - min(_MOST_LOG, left)))
                text = file.read(_MOST_LOG).decode("utf-8", "replace")
                if text:
                    left -= len(text)
                    found[f"logs/{path.name}"] = text
            if left <= 0:
                break
    return found


def merge_logs(logs: Mapping[str, str]) -> str:
    """The lines of logs by time, each with the name of its node; one without a time follows the line before it."""
    lines: list[tuple[str, int, str]] = []
    for file, text in logs.items():
        name = file.removeprefix("logs/").removesuffix(".log")
        moment = ""
        for line in text.splitlines():
            if stamp := _STAMP.search(line):
                moment = f"{stamp[1]}.{stamp[2]}"
            if moment:
                lines.append((moment, len(lines), f"{moment} {name}: {line}"))
    return "\n".join(line for _, _, line in sorted(lines)) + "\n"


def read_parameters(uri: str) -> object:
    """The parameters of a master of ROS 1; none where there is none."""
    if not uri.startswith("http"):
        return {}
    try:
        values = replace(parse_master_uri(uri), timeout=_WITHIN).call("getParam", "/")
    except (Unanswered, CallRefused, UserError):
        return {}
    return _plain(values) if isinstance(values, dict) else {}


def read_versions() -> dict[str, object]:
    """The versions of this computer's system, of ROS and of Python's packages."""
    release = {}
    with suppress(OSError):
        release = platform.freedesktop_os_release()
    packages = {each.name: each.version for each in metadata.distributions() if each.name}
    return {
        "system": release.get("PRETTY_NAME", platform.system()),
        "kernel": platform.release(),
        "machine": platform.machine(),
        "python": platform.python_version(),
        "ros": os.environ.get("ROS_DISTRO", ""),
        "packages": dict(sorted(packages.items())),
    }


def read_system() -> dict[str, object]:
    """The load, memory and free disk of this computer now."""
    found: dict[str, object] = {"time": _clock(time.time()), "load": list(os.getloadavg()), "cpus": os.cpu_count()}
    with suppress(OSError, ValueError):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()[:5]
        found["memory"] = {line.partition(":")[0]: line.partition(":")[2].strip() for line in lines}
    with suppress(OSError):
        found["uptime in s"] = float(Path("/proc/uptime").read_text(encoding="ascii").split()[0])
        status = os.statvfs("/")
        found["free disk in MB"] = status.f_bavail * status.f_frsize // 1_000_000
    return found


def write_values(values: object) -> str:
    """A tree of values as JSON."""
    return write_json(values) + "\n"


def _plain(value: object) -> object:
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value if isinstance(value, bool | int | float | str) or value is None else str(value)


def _clock(seconds: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(seconds))
