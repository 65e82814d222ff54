"""The regular expressions of `src`, and texts of their own alphabet; run as a program, it prints the slow ones.

A pattern is what a module's top level or a literal in a function gives to `re`; the methods are those that the module
calls it with. A text that takes long is compared with a quarter of it: linear time takes a quarter for that, quadratic
time a sixteenth.
"""

import ast
import re
import signal
import sys
import time
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from re import _constants, _parser  # type: ignore[attr-defined]
from types import FrameType
from typing import Any

SOURCE = Path(__file__).parents[2] / "src"
LENGTH = 65_536
SECONDS = 0.3
"""Processor time (s) from which on a text is compared with a quarter of it; linear time takes a hundredth mostly."""
GROWTH = 8.0
"""More than four times and less than sixteen times: longer than this times what a quarter takes is slow."""
_METHODS = {"match", "search", "fullmatch", "sub", "subn", "split", "findall", "finditer"}
_MOST_UNITS = 12


@dataclass(frozen=True)
class Pattern:
    """A pattern, None for one that is made while the program runs, and the methods that are called."""

    pattern: re.Pattern[Any] | None
    methods: frozenset[str]


def list_patterns(path: Path) -> Iterator[Pattern]:
    """The patterns of a module."""
    text = path.read_text(encoding="utf-8")
    if "re." not in text:
        return
    tree = ast.parse(text)
    values: dict[str, Any] = {"re": re, "frozenset": frozenset, "range": range, "dict": dict, "tuple": tuple}
    for statement in tree.body:
        if isinstance(statement, ast.Assign | ast.AnnAssign):
            with suppress(Exception):
                exec(compile(ast.Module([_plain(statement)], []), str(path), "exec"), values)
    used: dict[str, set[str]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr in _METHODS and isinstance(node.value, ast.Name):
            used.setdefault(node.value.id, set()).add(node.attr)
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Call):
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            if ast.unparse(node.value.func) == "re.compile" and isinstance(target, ast.Name):
                known = frozenset(used.get(target.id, {"search"}))
                yield Pattern(_evaluate(node.value, values), known)
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in {f"re.{each}" for each in _METHODS}:
            flags = [each for each in node.keywords if each.arg == "flags"]
            call = ast.Call(ast.parse("re.compile", mode="eval").body, node.args[:1], flags)
            yield Pattern(_evaluate(call, values), frozenset({node.func.attr}))  # type: ignore[attr-defined]


def _plain(statement: ast.Assign | ast.AnnAssign) -> ast.stmt:
    if isinstance(statement, ast.Assign):
        return statement
    return ast.copy_location(ast.Assign([statement.target], statement.value or ast.Constant(None)), statement)


def _evaluate(call: ast.Call, values: dict[str, Any]) -> re.Pattern[Any] | None:
    """The pattern of a call; None for one that is made while the program runs."""
    try:
        made = eval(compile(ast.fix_missing_locations(ast.Expression(call)), "pattern", "eval"), values)
    except (NameError, AttributeError, TypeError):
        return None
    return made if isinstance(made, re.Pattern) else None


def list_texts(pattern: re.Pattern[Any], length: int) -> Iterator[str]:
    """Texts that repeat a part of what a pattern matches, after its beginning, with an end that fails."""
    parsed = _parser.parse(pattern.pattern, pattern.flags & ~re.DEBUG)
    whole = "".join(_example(parsed))
    for unit in [*dict.fromkeys([whole, *_parts(parsed)])][:_MOST_UNITS]:
        if unit:
            yield f"{whole[:1]}{unit * (length // len(unit))}\0"


def count_unbounded(parsed: Any) -> int:
    """The number of repetitions without a limit."""
    count = 0
    for kind, argument in parsed:
        if kind in (_constants.MAX_REPEAT, _constants.MIN_REPEAT):
            count += argument[1] == _constants.MAXREPEAT
        for each in _below(argument):
            count += count_unbounded(each)
    return count


def _below(argument: Any) -> Iterator[Any]:
    if isinstance(argument, _parser.SubPattern):
        yield argument
    elif isinstance(argument, tuple | list):
        for each in argument:
            yield from _below(each)


def _parts(parsed: Any) -> Iterator[str]:
    run = ""
    for kind, argument in parsed:
        if kind is _constants.LITERAL:
            run += chr(argument)
            continue
        if run:
            yield run
            yield f"{run}-"
        run = ""
        example = "".join(_example([(kind, argument)]))
        if example:
            yield example
        for each in _below(argument):
            yield from _parts(each)
    if run:
        yield run


_CATEGORIES = {
    _constants.CATEGORY_DIGIT: "1",
    _constants.CATEGORY_WORD: "a",
    _constants.CATEGORY_SPACE: " ",
    _constants.CATEGORY_NOT_DIGIT: "a",
    _constants.CATEGORY_NOT_WORD: "-",
    _constants.CATEGORY_NOT_SPACE: "a",
}


def _example(parsed: Any) -> Iterator[str]:
    """The pieces of a text that a pattern matches, roughly: groups behind or ahead are left out."""
    for kind, argument in parsed:
        if kind is _constants.LITERAL:
            yield chr(argument)
        elif kind is _constants.NOT_LITERAL:
            yield "a" if argument != ord("a") else "b"
        elif kind is _constants.ANY:
            yield "a"
        elif kind is _constants.IN:
            yield _member(argument)
        elif kind in (_constants.MAX_REPEAT, _constants.MIN_REPEAT):
            yield "".join(_example(argument[2])) * max(1, min(argument[0], 3))
        elif kind is _constants.SUBPATTERN:
            yield from _example(argument[3])
        elif kind is _constants.BRANCH:
            yield from _example(argument[1][0])


def _member(members: Any) -> str:
    negated = members[0][0] is _constants.NEGATE
    for each in "a1 -._\"'<>:/=,;\n" if negated else ():
        if not re.match(_as_class(members), each):
            continue
        return each
    for kind, argument in members:
        if kind is _constants.LITERAL:
            return chr(argument)
        if kind is _constants.RANGE:
            return chr(argument[0])
        if kind is _constants.CATEGORY:
            return _CATEGORIES.get(argument, "a")
    return ""


def _as_class(members: Any) -> str:
    made = ""
    for kind, argument in members:
        if kind is _constants.NEGATE:
            made += "^"
        elif kind is _constants.LITERAL:
            made += re.escape(chr(argument))
        elif kind is _constants.RANGE:
            made += f"{re.escape(chr(argument[0]))}-{re.escape(chr(argument[1]))}"
        elif kind is _constants.CATEGORY:
            name = str(argument).rpartition("_")[2]
            letter = {"DIGIT": "d", "WORD": "w", "SPACE": "s"}[name]
            made += "\\" + (letter.upper() if "NOT" in str(argument) else letter)
    return f"[{made}]"


class Slow(Exception):  # noqa: N818 - says what happened
    """A pattern has taken longer than it was given."""


_running = False


def _stop(_: int, __: FrameType | None) -> None:
    if _running:
        raise Slow


def find_slow_text(each: Pattern, seconds: float = SECONDS, length: int = LENGTH) -> str | None:
    """Return the beginning of a text that takes a pattern more than linear time, None for none.

    `seconds` of processor time are linear for certain.
    """
    signal.signal(signal.SIGVTALRM, _stop)
    assert each.pattern is not None
    at_start = each.methods <= {"match", "fullmatch"}
    if count_unbounded(_parser.parse(each.pattern.pattern, each.pattern.flags & ~re.DEBUG)) <= at_start:
        return None  # linear: no repetition within or beside another, nor from each start
    quarters = list_texts(each.pattern, length // 4)
    for text, quarter in zip(list_texts(each.pattern, length), quarters, strict=True):
        for method in sorted(each.methods):
            if _is_slow(each.pattern, method, text, quarter, seconds):
                return f"{method} {text[:40]!r}"
    return None


def _is_slow(pattern: re.Pattern[Any], method: str, text: str, quarter: str, seconds: float) -> bool:
    with suppress(Slow):
        _search(pattern, method, text, seconds)
        return False
    with suppress(Slow):
        least = min(_search(pattern, method, quarter, 4 * seconds) for _ in range(3))
        _search(pattern, method, text, max(seconds, GROWTH * least))
        return False
    return True


def _search(pattern: re.Pattern[Any], method: str, text: str, seconds: float) -> float:
    """Return the seconds of processor time of a search; Slow where it takes longer than it is given."""
    global _running
    given: Any = text.encode("utf-8", "replace") if isinstance(pattern.pattern, bytes) else text
    words = (given[:0], given) if method in ("sub", "subn") else (given,)
    begin = time.process_time()
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        _running = True
        found = getattr(pattern, method)(*words)
        if method == "finditer":
            deque(found, 0)
        _running = False
    finally:
        _running = False
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    return time.process_time() - begin


def main() -> int:
    """Print the slow patterns, those that are not literals, and the number of patterns."""
    count = 0
    for path in [SOURCE / name for name in sys.argv[1:]] or sorted(SOURCE.rglob("*.py")):
        name = path.relative_to(SOURCE).as_posix()
        for each in list_patterns(path):
            count += 1
            if each.pattern is None:
                sys.stdout.write(f"made {name}\n")
            elif found := find_slow_text(each):
                sys.stdout.write(f"slow {name} {each.pattern.pattern[:90]!r}: {found}\n")
    sys.stdout.write(f"{count}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
