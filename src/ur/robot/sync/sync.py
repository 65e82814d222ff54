"""A sync: look at both sides, compare, carry with rsync, put in place, remember."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ur.robot.ssh.failures import lost_connection
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote
from ur.robot.sync import side as side_program
from ur.robot.sync.compare import agree, drop_ignored
from ur.robot.sync.memory import SyncMemory, WorkspacePair, known_files
from ur.robot.sync.steps import SIDES, Manifest, Side, SyncPlan, SyncStep, check_path, read_files
from ur.source.diagnostic import UserError, error, error_about

WORKSPACE = "catkin_ws/src"
_SECONDS = 1800.0  # a first look reads every file
_RSYNC_LOST = {10, 12, 30, 35, 255}  # rsync(1), exit values: socket I/O, protocol stream, two timeouts; and ssh's own


@dataclass(frozen=True, slots=True)
class SyncSide:
    """One side: where it is, and how to run something there. `shell` is None here."""

    side: Side
    shell: Shell | None


@dataclass(frozen=True, slots=True)
class Look:
    """The content of both sides without ignored files; the pair, and the last sync's memory if it is of this pair."""

    here: Manifest
    there: Manifest
    pair: WorkspacePair
    last: SyncMemory | None


@dataclass(frozen=True, slots=True)
class SyncOutcome:
    """The result of a sync: the memory for the next one, and the paths left alone, with the reasons, by side."""

    memory: SyncMemory
    left: Mapping[Side, Mapping[str, str]]


@dataclass(frozen=True, slots=True)
class _Scan:
    """The workspace of a side, as that side describes it."""

    manifest: Manifest
    root: str
    machine: str
    has_rsync: bool
    ignored: tuple[str, ...]


_BAD_ANSWER = (LookupError, TypeError, ValueError, AttributeError)


def look_at(shell: SshShell, root: Path, last: SyncMemory | None) -> Look:
    """List both workspaces. Raises UserError."""
    agreed = last.agreed if last else {}
    answers = {}
    for place, where in ((SyncSide("here", None), str(root)), (SyncSide("there", shell), f"~/{WORKSPACE}")):
        request = {"do": "scan", "root": where, "ignore": [], "known": known_files(agreed, place.side)}
        answers[place.side] = _read_scan(place, _ask(place, request))
        if not answers[place.side].has_rsync:
            who = "this computer" if place.side == "here" else shell.place
            raise UserError(
                error_about(
                    who, "rsync is not installed", rule="missing-program", help="there: sudo apt-get install rsync"
                )
            )
    patterns = [*answers["here"].ignored, *answers["there"].ignored]
    sides = [drop_ignored(answers[side].manifest, patterns) for side in SIDES]
    pair = WorkspacePair(answers["here"].root, answers["there"].root, answers["there"].machine)
    return Look(sides[0], sides[1], pair, last if last and last.pair == pair else None)


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
    """Carry out a plan's steps. `name` marks this viewer's arriving files; `stamp` names the folder of kept ones.

    Interrupted anywhere, every file is either as it was or as it shall be. Raises UserError: the connection broke.
    """
    roots = {"here": pair.here, "there": pair.there}
    places = {"here": SyncSide("here", None), "there": SyncSide("there", shell)}
    done: dict[Side, dict[str, Any]] = {"here": {}, "there": {}}
    left: dict[Side, dict[str, str]] = {"here": {}, "there": {}}
    for side in ("there", "here"):
        steps = [step for step in plan.steps if step.to == side]
        if not steps:
            continue
        beside = Path(roots[side]).parent / ".ur_sync"
        request = {"root": roots[side], "arriving": f"{beside}/arriving-{name}", "kept": f"{beside}/kept/{stamp}"}
        _ask(places[side], {**request, "do": "prepare"})
        paths = [step.path for step in steps if step.after and step.after.kind == "file"]
        if paths:
            count = f"{len(paths)} file{'' if len(paths) == 1 else 's'}"
            report(f"{count} to {'this computer' if side == 'here' else shell.place} ...")
            _run_rsync(shell, side, roots, request["arriving"], paths, progress=progress)
        answer = _ask(places[side], {**request, "do": "apply", "steps": [_render_step(step) for step in steps]})
        try:
            done[side] = {**read_files({k: v for k, v in answer["done"].items() if v}), **_deleted(answer["done"])}
            left[side] = _read_texts(answer["left"])
        except _BAD_ANSWER as problem:
            raise _misshapen(places[side], problem) from None
    return SyncOutcome(SyncMemory(pair, agree(plan, done)), left)


def _read_scan(place: SyncSide, answer: Any) -> _Scan:
    try:
        return _Scan(
            Manifest(read_files(answer["files"]), _read_texts(answer["skipped"])),
            str(answer["root"]),
            str(answer["machine"]),
            bool(answer["rsync"]),
            tuple(str(each) for each in answer["ignore"]),
        )
    except _BAD_ANSWER as problem:
        raise _misshapen(place, problem) from None


def _read_texts(rows: Mapping[str, Any]) -> dict[str, str]:
    return {path and check_path(path): str(why) for path, why in rows.items()}  # '' is the workspace itself


def _misshapen(place: SyncSide, problem: Exception) -> UserError:
    who = "this computer" if place.shell is None else place.shell.place
    message = f"{who}: the list of its workspace makes no sense: {problem}"
    return UserError(error(message, rule="failed-sync", help="ur doctor"))


def _deleted(done: Mapping[str, Any]) -> dict[str, None]:
    return {check_path(path): None for path, row in done.items() if row is None}


def _render_step(step: SyncStep) -> list[Any]:
    before, after = (each.as_json() if each else None for each in (step.before, step.after))
    return [step.path, before, after, step.keep]


def _ask(place: SyncSide, request: Mapping[str, Any]) -> Any:
    if place.shell is None:
        # Through JSON as well: both sides answer alike.
        answer = {"scan": side_program.scan, "prepare": side_program.prepare, "apply": side_program.apply}[
            request["do"]
        ](json.loads(json.dumps(request)))
        return json.loads(json.dumps(answer))
    source = base64.b64encode(zlib.compress(Path(side_program.__file__).read_bytes())).decode()
    code = f"import base64,zlib;exec(zlib.decompress(base64.b64decode('{source}')))"
    done = place.shell.run(quote("python3", "-I", "-c", code), stdin=json.dumps(request), timeout=_SECONDS)
    try:
        return json.loads(done.out)
    except (ValueError, RecursionError):
        reason = (done.err.strip().splitlines() or [f"exit code {done.code}"])[-1]
        raise UserError(
            error_about(
                place.shell.place, f"its workspace cannot be read: {reason}", rule="failed-sync", help="ur doctor"
            )
        ) from None


def rsync_command(
    ssh: Sequence[str], address: str, to: Side, roots: Mapping[str, str], arriving: str, *, progress: bool
) -> list[str]:
    """The words that bring files, named on standard input, into a folder beside the workspace of side `to`.

    What lies there from an interrupted transfer, and the file that is to be replaced, are built upon.
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
        command,
        stdin=subprocess.PIPE,
        stdout=None if progress else subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    ) as process:
        try:
            _, reported = process.communicate("\0".join(paths).encode(errors="surrogateescape"))
        except BaseException:
            process.terminate()
            raise
    if process.returncode in _RSYNC_LOST:
        raise lost_connection(shell.place, reported.decode(errors="replace"))
    # 23 and 24: some files changed or vanished meanwhile. They are missed when the rest is put in its place.
    if process.returncode not in (0, 23, 24):
        lines = reported.decode(errors="replace").strip().splitlines() or [f"exit code {process.returncode}"]
        raise UserError(error_about(shell.place, f"rsync: {lines[0]}", rule="failed-sync", help="ur doctor"))
    sys.stdout.flush()
