"""Expansion of a xacro file to the text of a URDF.

xacro runs Python of the file and of the files that it includes. It does so in a process that can only compute; if that
is not possible, the user is asked first.
"""

import json
import os
import re
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import islice
from pathlib import Path
from threading import Timer
from typing import IO, Literal

from ur.robot.description.surroundings import Surroundings, is_safe_program
from ur.source.arguments import split_argv
from ur.source.diagnostic import UserError, error
from ur.source.read import read_source

SECONDS = 60  # s of processor time, and in all; xacro files may be recursive without end
MEMORY = 1 << 30  # bytes of address space
MOST_SENT = 20_000_000  # bytes of one message of the process
MOST_READ = 100_000_000  # bytes of all files that one description includes
MOST_QUESTIONS = 100_000
SECCOMP = "libseccomp.so.2"  # apt depends on it, so Debian and Ubuntu always have it
_SCRIPT = Path(__file__).with_name("confined.py")


@dataclass(frozen=True, slots=True)
class ExpansionBounds:
    """Limits of an expansion in seconds and number of requests, and the library that confines the process (seccomp)."""

    seconds: int = SECONDS
    questions: int = MOST_QUESTIONS
    seccomp: str = SECCOMP


BOUNDS = ExpansionBounds()


@dataclass(frozen=True, slots=True)
class Expansion:
    """The result of an expansion: the URDF `text`, or a `problem` that is not empty.

    `unconfined` is the reason why the process could not be confined; then nothing of the description was executed.
    `missing` are packages that were requested but not found.
    """

    text: str = ""
    problem: str = ""
    unconfined: str = ""
    missing: tuple[str, ...] = ()


class QuestionRefused(Exception):  # noqa: N818 - an answer, with its reason
    """A request of the process that is refused, with the reason."""


Answer = Callable[[str], object]


def expand(
    order: Mapping[str, object],
    answers: Mapping[str, Answer],
    *,
    confined: bool = True,
    bounds: ExpansionBounds = BOUNDS,
) -> Expansion:
    """Run xacro as `order` describes (`library`, `file`, `folder`, `arguments`), and answer its requests by their kind.

    An answer raises QuestionRefused. Unless it is `confined`, the process has all rights of its parent.
    """
    child = subprocess.Popen(
        [sys.executable, "-I", str(_SCRIPT)],
        env={"LC_ALL": "C.UTF-8", "HOME": "/"},  # no environment variables of the user
        cwd="/",
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    timer = Timer(bounds.seconds, child.kill)
    timer.start()
    assert child.stdin
    assert child.stdout
    limits = {"memory": MEMORY, "seconds": bounds.seconds, "seccomp": bounds.seccomp if confined else ""}
    try:
        report = _converse(child.stdin, child.stdout, {**order, **limits}, answers, bounds.questions)
    except (BrokenPipeError, EOFError):
        report = None
    except (ValueError, KeyError):
        report = _Message(end="done", problem="it sent what xacro does not send")
    finally:
        late = not timer.is_alive()
        timer.cancel()
        child.kill()
        child.wait()
        child.stdout.close()
        with suppress(BrokenPipeError):  # the process ended before it read the last answer
            child.stdin.close()
    if report:
        return _read_report(report)
    return Expansion(problem=f"it did not finish within {bounds.seconds} s" if late else "it ended without a result")


@dataclass(frozen=True, slots=True)
class _Message:
    """A line from the process: `ask` requests the thing with the name `of`; `end` has the result."""

    ask: str = ""
    of: str = ""
    end: Literal["", "done", "not confined"] = ""
    text: str = ""
    problem: str = ""
    errors: str = ""
    missing: tuple[str, ...] = ()


def _converse(
    to: IO[bytes], of: IO[bytes], order: Mapping[str, object], answers: Mapping[str, Answer], most: int
) -> _Message:
    from ur.source.foreign.json_values import read_json  # imported late: only expansions need it

    _send(to, order)
    for _ in range(most):
        line = of.readline(MOST_SENT)
        if not line.endswith(b"\n"):
            if len(line) == MOST_SENT:
                return _Message(end="done", problem=f"the result is larger than {MOST_SENT:,} bytes")
            raise EOFError
        message = read_json(line, _Message, MOST_SENT)
        if message.end:
            return message
        try:
            _send(to, {"value": answers[message.ask](message.of)})
        except QuestionRefused as reason:
            _send(to, {"error": str(reason)})
    return _Message(end="done", problem=f"it asked for more than {most:,} files and packages")


def _send(to: IO[bytes], fields: Mapping[str, object]) -> None:
    to.write(json.dumps(fields).encode() + b"\n")
    to.flush()


def _read_report(report: _Message) -> Expansion:
    if report.end == "not confined":
        return Expansion(unconfined=report.problem or "no reason is known")
    lines = [line for line in report.errors.strip().splitlines() if line.strip() not in ("", "error:")]
    problem = report.problem and (lines or [report.problem])[0]
    return Expansion(report.text, problem, missing=tuple(dict.fromkeys(report.missing)))


_MOST_FILES = 1000  # of files that match one pattern of an include
_WILD = re.compile(r"[*?\[]")

Packages = Callable[[], Mapping[str, str]]


@dataclass(frozen=True, slots=True)
class DescriptionText:
    """The text of a URDF, and the packages that its xacro file includes but that are not installed."""

    text: str
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ExpansionComputer:
    """The parts of this computer that an expansion uses.

    `packages` finds the folders of packages by name, and is called for xacro files only. `made` is the folder of the
    packages that `ur get` builds. `consent` is called with the command where xacro cannot be confined. `has_own`
    returns whether the project's environment has xacro.
    """

    environment: Mapping[str, str]
    packages: Packages
    made: Path
    consent: Callable[[str], bool]
    bounds: ExpansionBounds = BOUNDS
    has_own: Callable[[], bool] | None = None


def read_description(
    path: Path, around: Surroundings, computer: ExpansionComputer, arguments: Sequence[str] = ()
) -> DescriptionText:
    """Read a URDF file; a file named `.xacro` is expanded, with the given arguments and the defaults of all others.

    `arguments` are NAME:=VALUE. Raises UserError.
    """
    text = read_source(path, expected="a URDF or xacro file").text
    if path.suffix == ".xacro":
        return _expand(path, around, computer, arguments)
    if arguments:
        message = f"'{path}' is no xacro file, which takes no argument {arguments[0]!r}"
        help_ = "leave it out, or give the file a name that ends with .xacro"
        raise UserError(error(message, rule="bad-value", help=help_, subject=arguments[0]))
    return DescriptionText(text)


def _expand(path: Path, around: Surroundings, computer: ExpansionComputer, arguments: Sequence[str]) -> DescriptionText:
    library = find_library(computer.made, around, computer.has_own or _has_own)
    if library is None:
        outcome = _run_program(path, around, computer, arguments)
    else:
        order = {"library": library, "file": str(around.file), "folder": str(Path.cwd()), "arguments": list(arguments)}
        answers = _list_answers(around, computer)
        outcome = expand(order, answers, bounds=computer.bounds)
        if outcome.unconfined:
            _ask(path, f"xacro cannot be confined here ({outcome.unconfined})", computer)
            outcome = expand(order, answers, confined=False, bounds=computer.bounds)
    if not outcome.problem:
        return DescriptionText(outcome.text, outcome.missing)
    reason = re.sub(r"\x1b\[[0-9;]*m", "", outcome.problem)
    message = f"xacro cannot expand '{path}': {reason[:300]}"
    missing = " ".join(outcome.missing)
    help_ = "source the setup.bash of the workspace that holds the packages it names"
    help_ = f"ur get {missing}, or {help_}" if missing else help_
    wanted = re.search(r"Undefined substitution argument (\w+)", reason)
    if wanted and wanted[1] not in split_argv(arguments).values:
        help_ = f"its argument has no default: add {wanted[1]}:=VALUE to the command"
    raise UserError(error(message, rule="bad-xacro", help=help_, subject=str(path), reason=reason))


def _ask(path: Path, why: str, computer: ExpansionComputer, help_: str = "") -> None:
    what = f"{why}, so Python in '{path}' and in the files that it includes would run with all your rights"
    if not computer.consent(what):
        help_ = (
            help_ or "read these files and answer y in a terminal, or give the URDF that xacro makes of it elsewhere"
        )
        raise UserError(error(f"did not expand '{path}': {what}", rule="not-confined", help=help_, subject=str(path)))


def _run_program(path: Path, around: Surroundings, computer: ExpansionComputer, arguments: Sequence[str]) -> Expansion:
    """Run the program xacro, which is not confined, if the user consents."""
    program, refused = find_program(computer.environment, around)
    if program is None:
        message = f"cannot expand '{path}': there is no xacro on this computer"
        if refused:
            message += f", beside '{refused[0]}', which others may have put there"
        help_ = "run 'ur get xacro', or give the URDF that xacro makes of it elsewhere"
        raise UserError(error(message, rule="no-xacro", help=help_, subject=str(path)))
    help_ = "run 'ur get xacro', which installs a xacro that can be confined"
    _ask(path, f"the program '{program}' cannot be confined", computer, help_)
    paths = {name: clean_path(computer.environment.get(name, ""), around) for name in ("PATH", "PYTHONPATH")}
    try:
        done = subprocess.run(
            [program, str(around.file), *arguments],
            env={**computer.environment, **paths, "PYTHONSAFEPATH": "1"},
            cwd="/",
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            timeout=SECONDS,
        )
    except subprocess.TimeoutExpired:
        return Expansion(problem=f"it did not finish within {SECONDS} s")
    except OSError as failed:
        return Expansion(problem=f"'{program}' does not start: {(failed.strerror or str(failed)).lower()}")
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    problem = (lines[0] if lines else f"exit code {done.returncode}") if done.returncode else ""
    return Expansion(done.stdout.decode(errors="replace"), problem)


def _list_answers(around: Surroundings, computer: ExpansionComputer) -> Mapping[str, Answer]:
    """Return the answers to a confined xacro, by the kind of its request: files, packages, variables."""
    packages = dict(computer.packages())
    left = MOST_READ

    def read(path: str) -> str:
        nonlocal left
        found = around.find_readable(path, packages.values())
        if found is None:
            raise QuestionRefused(f"outside of '{around.folder}' and of all packages, or hidden")
        try:
            text = read_source(found).text
        except UserError as problem:
            reason = problem.diagnostics[0].message.removeprefix(f"{found}: ")
            raise QuestionRefused(reason) from None
        left -= len(text)
        if left < 0:
            raise QuestionRefused(f"more than {MOST_READ:,} bytes are included in all")
        return text

    def find(pattern: str) -> list[str]:
        return list(islice(_match(pattern, around, packages), _MOST_FILES))

    return {"file": read, "files": find, "package": packages.get, "variable": computer.environment.get}


def _match(pattern: str, around: Surroundings, packages: Mapping[str, str]) -> Iterator[str]:
    """Yield the readable files that match the pattern of an include, below its last folder without wildcards."""
    parts = Path(pattern).parts
    fixed = next((number for number, part in enumerate(parts) if _WILD.search(part)), len(parts) - 1)
    folders = [Path(*parts[:fixed])]
    for part in parts[fixed:-1]:
        folders = [entry for folder in folders for entry in _list_folder(folder, part, around, packages)]
    for folder in folders:
        yield from map(str, _list_folder(folder, parts[-1], around, packages))


def _list_folder(folder: Path, pattern: str, around: Surroundings, packages: Mapping[str, str]) -> list[Path]:
    if around.find_readable(folder, packages.values()) is None:
        return []
    try:
        names = sorted(entry for entry in os.listdir(folder) if fnmatchcase(entry, pattern) and entry[0] != ".")  # noqa: PTH208
    except OSError:
        return []
    return [folder / name for name in names[:_MOST_FILES]]


def _has_own() -> bool:
    return find_own() is not None


def find_library(made: Path, around: Surroundings, has_own: Callable[[], bool] = _has_own) -> str | None:
    """Find the folder to import xacro from: "" for the project's environment, or the package that `ur get` has built.

    `made` is the folder of the packages that `ur get` builds. None if xacro is not found.
    """
    if has_own():
        return ""
    library = made / "xacro" / "lib"
    return str(library) if (library / "xacro/__init__.py").is_file() and not around.holds(library) else None


def find_own() -> Path | None:
    """Find the folder of xacro in the project's environment; None if it is not installed."""
    folders = [Path(sysconfig.get_path(kind), "xacro") for kind in ("purelib", "platlib")]
    return next((folder for folder in folders if (folder / "__init__.py").is_file()), None)


def find_program(environment: Mapping[str, str], around: Surroundings) -> tuple[str | None, tuple[str, ...]]:
    """Return the first program xacro on PATH that is safe to run, and the earlier ones that are not."""
    refused: list[str] = []
    for folder in environment.get("PATH", "").split(os.pathsep):
        program = os.path.join(folder, "xacro")  # noqa: PTH118 - a relative one stays so
        if not os.path.isfile(program) or not os.access(program, os.X_OK):  # noqa: PTH113
            continue
        if (
            Path(folder).is_absolute()
            and not around.holds(program)
            and not around.holds(folder)
            and is_safe_program(program)
        ):
            return program, tuple(refused)
        refused.append(program)
    return None, tuple(refused)


def clean_path(value: str, around: Surroundings) -> str:
    """Return the folders of a variable such as PATH that are absolute and not around the description."""
    folders = [each for each in value.split(os.pathsep) if os.path.isabs(each) and not around.holds(each)]  # noqa: PTH117
    return os.pathsep.join(folders)
