"""Heads of scripts: the interpreter that the first line names, and whether that reads the text."""

import os
import re
import shlex
import sys
import warnings
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Literal, NamedTuple

from ur.source.foreign.files import read_file

MAX_SCRIPT = 1024 * 1024
_BINARY = (b"\x7fELF", b"\x00")
_BOM = b"\xef\xbb\xbf"
_TWO_BY_MESSAGE = re.compile(
    r"Missing parentheses in call to '(?:print|exec)'|multiple exception types must be parenthesized|"
    r"leading zeros in decimal|inconsistent use of tabs"
)
_TWO_BY_LINE = re.compile(
    r"^\s*raise\s+[\w.]+\s*,|^\s*except\s+[\w.]+\s*,|^\s*(?:print|exec)\s+\S|`|<>|\bur['\"]|\d[lL]\b"
)


class ScriptFault(NamedTuple):
    """A reason why a script does not start, at a position of its text."""

    kind: Literal["head", "line-endings", "interpreter", "text"]
    start: int
    end: int
    message: str
    help: str


def find_script_faults(path: str, data: bytes, find_program: Callable[[str], str]) -> Iterator[ScriptFault]:
    """Yield what keeps a script from starting: its head, then its text. Binaries have no faults.

    `find_program` returns the path of an interpreter, by its name or path; `""` if it is not installed.
    """
    if not data or len(data) > MAX_SCRIPT or data.startswith(_BINARY) or b"\x00" in data[:1024]:
        return
    text = data.decode("utf-8", "replace")
    line = text.partition("\n")[0]
    file = shlex.quote(path)
    if not line.startswith("#!"):
        hidden = data.startswith((_BOM, b"\n", b"\r", b" ")) and data.lstrip(_BOM + b"\r\n ").startswith(b"#!")
        help_ = "remove what is before '#!'" if hidden else f"write '#!/usr/bin/env {_guess(path)}' as the first line"
        yield ScriptFault(
            "head", 0, max(len(line), 1), "the file does not begin with '#!', expected its interpreter", help_
        )
        return
    if line.endswith("\r"):
        message = f"Windows line endings: {line[2:].strip()!r} is searched for with a carriage return, and not found"
        yield ScriptFault("line-endings", 0, len(line) - 1, message, f"sed -i 's/\\r$//' {file}")
    program, _, rest = line[2:].strip().partition(" ")
    if program.rpartition("/")[2] == "env":
        rest = rest.strip()
        words = [word for word in rest.split() if not word.startswith("-") and "=" not in word]
        program = words[0] if words else ""
        if " " in rest and not rest.startswith(("-S", "--split-string")):
            message = f"'env' searches for a program named {rest!r}: Linux passes all that follows as one argument"
            yield ScriptFault("head", 0, len(line.rstrip()), message, f"write '#!/usr/bin/env -S {rest}'")
    name = program.rpartition("/")[2]
    found = find_program(program) if program else ""
    if program and not found:
        yield ScriptFault(
            "interpreter",
            0,
            len(line.rstrip()),
            f"interpreter '{program}' is not installed",
            _replace(name, file, find_program),
        )
    actual = os.path.realpath(found).rpartition("/")[2] if found else name
    if name.startswith("python") and not re.match(r"python2|pypy", actual if found else name):
        yield from _compile_once(path, data, (actual == f"python{sys.version_info[0]}.{sys.version_info[1]}"))


def explain_script(path: str, search_path: str | None) -> str:
    """Return in one line why the program at a path does not start, and the fix; `""` if its text shows no reason."""
    from shutil import which  # only once a node has died

    try:
        data = read_file(path, MAX_SCRIPT)
    except (OSError, ValueError):
        return ""
    faults = find_script_faults(path, data, lambda name: which(name, path=search_path) or "")
    return next((f"{each.message}: {each.help}" for each in faults), "")


def _guess(path: str) -> str:
    return "bash" if path.endswith((".sh", ".bash")) else "python3"


def _replace(name: str, file: str, find_program: Callable[[str], str]) -> str:
    if name.startswith("python") and find_program("python3"):
        return f"python3 is: sed -i '1s/{name}/python3/' {file}"
    return f"install {name}, or name another interpreter in the first line"


@lru_cache(maxsize=256)  # a check asks for each node in each case
def _compile_once(path: str, data: bytes, every: bool) -> tuple[ScriptFault, ...]:
    return tuple(_compile(path, data, every))


def _compile(path: str, data: bytes, every: bool) -> Iterator[ScriptFault]:
    # Another version of Python 3 may read what this one does not: then only the errors of Python 2 count.
    from ast import PyCF_ONLY_AST

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(data, path, "exec", PyCF_ONLY_AST)
        return
    except SyntaxError as problem:
        number, reason = problem.lineno or 1, problem.msg or ""
    except (ValueError, RecursionError, MemoryError):
        return
    lines = data.decode("utf-8", "replace").split("\n")
    number = min(max(number, 1), len(lines))
    start = sum(len(line) + 1 for line in lines[: number - 1])
    line = lines[number - 1].rstrip()
    start, end = start + len(line) - len(line.lstrip()), start + max(len(line), 1)
    if is_python_two(reason, line):
        yield ScriptFault(
            "text", start, end, f"Python 3 does not read this, which is Python 2: {reason}", convert_help(path, reason)
        )
    elif every:
        yield ScriptFault(
            "text", start, end, f"not valid Python: {reason}", "correct the line; 'ur check' reads it again"
        )


def is_python_two(reason: str, line: str) -> bool:
    """Return whether a SyntaxError with this reason and line comes from a text of Python 2."""
    return bool(_TWO_BY_MESSAGE.search(reason) or _TWO_BY_LINE.search(line))


def convert_help(path: str, reason: str) -> str:
    """Return the commands that convert a script of Python 2."""
    file = shlex.quote(path)
    if "tabs" in reason:
        return f"indent it with spaces alone, as 'expand -i {file}' prints it"
    return f"2to3 -w {file} converts it (sudo apt-get install 2to3)"
