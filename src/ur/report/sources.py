"""The content of a report besides the recording: logs, parameters, environment, versions and load."""

import os
import platform
import re
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from importlib import metadata
from pathlib import Path

from ur.run.master.client import parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.record.registry import EndedRun, RunEntry, plan_path, read_plan
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import write_json

_MOST_LOG = 1_000_000  # bytes from the end of a log
_MOST_LOGS = 8_000_000  # of all logs
_WITHIN = 1.0  # s for a master
_STAMP = re.compile(r"(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d)[,.](\d{3})")
_NAMES = re.compile(
    r"(ROS|UR|AMENT|COLCON|CMAKE|PYTHON|RMW|CYCLONEDDS|FASTRTPS|XDG|LANG|DISPLAY|TERM|PATH|HOME|USER)\w*"
)


@dataclass(frozen=True, slots=True)
class RunSources:
    """Texts by the names of their files, and trees of values by the name of theirs."""

    texts: dict[str, str] = field(default_factory=dict)
    values: dict[str, object] = field(default_factory=dict)


def collect(entry: RunEntry, ended: EndedRun | None, environment: Mapping[str, str]) -> RunSources:
    """Collect what is known of a run; what cannot be read is left out."""
    plan = read_plan(plan_path(entry.log_folder, entry.run))
    texts = read_logs(Path(entry.log_folder))
    texts["logs/all.txt"] = merge_logs(texts)
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
    # The load, memory and free disk of this computer now
    found: dict[str, object] = {"time": _clock(time.time()), "load": list(os.getloadavg()), "cpus": os.cpu_count()}
    with suppress(OSError, ValueError):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()[:5]
        found["memory"] = {line.partition(":")[0]: line.partition(":")[2].strip() for line in lines}
    with suppress(OSError):
        found["uptime in s"] = float(Path("/proc/uptime").read_text(encoding="ascii").split()[0])
        status = os.statvfs("/")
        found["free disk in MB"] = status.f_bavail * status.f_frsize // 1_000_000
    values: dict[str, object] = {
        "run.json": run,
        "plan.json": plan,
        "parameters.json": read_parameters(entry.master_uri) if ended is None else {},
        "environment.json": {name: value for name, value in sorted(environment.items()) if _NAMES.match(name)},
        "versions.json": read_versions(),
        "system.json": found,
    }
    return RunSources(texts, values)


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
