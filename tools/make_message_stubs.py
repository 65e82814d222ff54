"""Make the stubs of the ROS messages that this project imports, for mypy: `stubs/PACKAGE/msg.pyi` and `srv.pyi`.

    .venv/bin/python tools/make_message_stubs.py

A class has the fields of both versions of ROS, as a program is written for both. Definitions of ROS 1 are those in the
Python modules of Debian's packages, definitions of ROS 2 are the files in `.ros2/share`.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Literal

from ur_nodes.codecs.vision.fiducial_messages import message_classes

ROOT = Path(__file__).parents[1]
STUBS = ROOT / "stubs"
ROS_2 = ROOT / ".ros2/share"
FOLDERS = ("src", "tests", "tools", "bench")
UNKNOWN = {"map_msgs"}  # packages that neither Debian's set-up nor `.ros2` has
_HEAD = '"""Made by tools/make_message_stubs.py. Do not edit."""\n'
_PLAIN = {"bool": "bool", "string": "str", "wstring": "str", "float32": "float", "float64": "float"}
_MOMENTS = {
    "time": "genpy.Time",
    "duration": "genpy.Duration",
    "builtin_interfaces/Time": "genpy.Time",
    "builtin_interfaces/Duration": "genpy.Duration",
}
_FIELD = re.compile(r"([A-Za-z][\w/]*)(?:<=\d+)?(\[[<=\d]*\])?\s+(\w+)\s*(=)?")
_NUMBER = re.compile(r"(?:u?int(?:8|16|32|64)|byte|char)")

Part = Literal["msg", "srv"]


@dataclass(slots=True)
class Definition:
    """Fields and constants of a message by name, each with its type as Python has it; `needs` are other packages."""

    fields: dict[str, str] = field(default_factory=dict)
    constants: dict[str, str] = field(default_factory=dict)
    needs: set[tuple[str, str]] = field(default_factory=set)


def find_imports(root: Path = ROOT) -> dict[tuple[str, Part], set[str]]:
    """The names of messages that modules of this project import, by package and part."""
    found: dict[tuple[str, Part], set[str]] = {}
    for path in (each for folder in FOLDERS for each in sorted((root / folder).rglob("*.py"))):
        text = path.read_text(encoding="utf-8")
        if ".msg" not in text and ".srv" not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.ImportFrom) or node.level or not node.module:
                continue
            package, _, part = node.module.rpartition(".")
            if part in ("msg", "srv") and "." not in package and package not in UNKNOWN:
                found.setdefault((package, part), set()).update(each.name for each in node.names)  # type: ignore[arg-type]  # it is one of both
    return found


def read_ros_1(package: str, name: str, part: Part) -> list[str] | None:
    """The definition of a message, or of a service's request and response, in Debian's module. None: it has none."""
    try:
        if package == "fiducial_msgs":  # made by the codec where it is not installed
            array, element = message_classes(name if name.endswith("Array") else f"{name}Array")
            return [(array if name.endswith("Array") else element)._full_text.partition("\n====")[0]]  # noqa: SLF001 - genpy's name
        found = getattr(import_module(f"{package}.{part}"), name)
    except (ImportError, AttributeError):
        return None
    classes = (found,) if part == "msg" else (found._request_class, found._response_class)  # noqa: SLF001 - genpy's names
    return [each._full_text.partition("\n====")[0] for each in classes]  # noqa: SLF001 - likewise


def read_ros_2(package: str, name: str, part: Part) -> list[str] | None:
    """The same in the files of ROS 2."""
    path = ROS_2 / package / part / f"{name}.{part}"
    if not path.is_file():
        return None
    text = path.read_text(encoding="utf-8")
    return [text] if part == "msg" else re.split(r"^---$", text, flags=re.MULTILINE)


def parse_definition(text: str, package: str, part: Part) -> Definition:
    """Parse a definition of a message, or of one half of a service."""
    found = Definition()
    for line in text.splitlines():
        match = _FIELD.match(line.partition("#")[0].strip())
        if match is None:
            continue
        kind, array, name, constant = match.groups()
        if constant:
            found.constants[name] = _python_type(kind, package, part, found)
        elif array is None:
            found.fields[name] = _python_type(kind, package, part, found)
        else:
            inner = _python_type(kind, package, part, found)
            if kind in ("uint8", "char"):
                found.fields[name] = "bytes"
                continue
            plain = kind in _PLAIN or _NUMBER.fullmatch(kind)
            fixed = plain and array.strip("[]").isdigit()
            found.fields[name] = f"{'MutableSequence' if fixed else 'Sequence' if plain else 'list'}[{inner}]"
    return found


def _python_type(kind: str, package: str, part: Part, found: Definition) -> str:
    if kind in _PLAIN:
        return _PLAIN[kind]
    if _NUMBER.fullmatch(kind):
        return "int"
    if kind in _MOMENTS:
        return _MOMENTS[kind]
    owner, _, name = kind.rpartition("/")
    owner = owner.removesuffix("/msg") or ("std_msgs" if kind == "Header" else package)
    found.needs.add((owner, name))
    return name if (owner, part) == (package, "msg") else f"{owner}.msg.{name}"


def merge(versions: Iterable[Definition]) -> Definition:
    """One definition with the fields of all."""
    merged = Definition()
    for each in versions:
        merged.fields = each.fields | merged.fields if not merged.fields else merged.fields | each.fields
        merged.constants |= each.constants
        merged.needs |= each.needs
    return merged


def read_all(imports: Mapping[tuple[str, Part], set[str]]) -> dict[tuple[str, Part], dict[str, list[Definition]]]:
    """The definitions of messages and services, and of what they hold. Raises LookupError: not installed."""
    waiting = [(package, part, name) for (package, part), names in sorted(imports.items()) for name in sorted(names)]
    found: dict[tuple[str, Part], dict[str, list[Definition]]] = {}
    while waiting:
        package, part, name = waiting.pop()
        own = re.sub("(Request|Response)$", "", name) if part == "srv" else name
        if own in found.setdefault((package, part), {}):
            continue
        texts = [each for each in (read_ros_1(package, own, part), read_ros_2(package, own, part)) if each is not None]
        if not texts:
            raise LookupError(f"{package}/{own}: no definition is installed")
        found[package, part][own] = [
            merge(parse_definition(text, package, part) for text in same) for same in zip(*texts, strict=True)
        ]
        waiting += [(owner, "msg", need) for each in found[package, part][own] for owner, need in sorted(each.needs)]
    return found


def write_stubs(imports: Mapping[tuple[str, Part], set[str]]) -> dict[str, str]:
    """The text of each stub by its path below `stubs`."""
    files: dict[str, str] = {}
    for (package, part), messages in sorted(read_all(imports).items()):
        needs = {owner for each in messages.values() for one in each for owner, _ in one.needs} - (
            {package} if part == "msg" else set()
        )
        body = "\n\n".join(text for name in sorted(messages) for text in _write(name, messages[name], part))
        kinds = [each for each in ("MutableSequence", "Sequence") if re.search(rf"\b{each}\[", body)]
        lines = [_HEAD, f"from collections.abc import {', '.join(kinds)}\n" if kinds else ""]
        lines += ["from typing import ClassVar, TypeAlias\n" if "ClassVar" in body else ""]
        lines += ["import genpy\n", *(f"import {owner}.msg\n" for owner in sorted(needs)), "\n", body, "\n"]
        files[f"{package}/{part}.pyi"] = _format("".join(lines))
        files.setdefault(f"{package}/__init__.pyi", _HEAD)
    return files


def _format(text: str) -> str:
    command = (sys.executable, "-m", "ruff", "format", "--line-length=120", "--stdin-filename=msg.pyi", "-")
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def _write(name: str, definitions: list[Definition], part: Part) -> Iterator[str]:
    if part == "msg":
        yield _write_class(name, definitions[0])
        return
    request, response = definitions
    yield _write_class(f"{name}Request", request)
    yield _write_class(f"{name}Response", response)
    yield "\n".join(
        [
            f"class {name}:",
            "    _type: ClassVar[str]",
            "    _md5sum: ClassVar[str]",
            f"    _request_class: ClassVar[type[{name}Request]]",
            f"    _response_class: ClassVar[type[{name}Response]]",
            f"    Request: TypeAlias = {name}Request  # of ROS 2, as is the next",
            f"    Response: TypeAlias = {name}Response",
        ]
    )


def _write_class(name: str, found: Definition) -> str:
    lines = [f"class {name}(genpy.Message):"]
    lines += [f"    {each}: {kind}" for each, kind in (found.constants | found.fields).items()]
    arguments = "".join(f", {each}: {kind} = ..." for each, kind in found.fields.items())
    lines.append(f"    def __init__(self{arguments}) -> None: ...")
    return "\n".join(lines)


def main() -> int:
    """Write the stubs. Returns the exit code."""
    for name, text in write_stubs(find_imports()).items():
        path = STUBS / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
