"""The bases of a repository: their sensors, and the bases that a launch file supports."""

import re
from collections.abc import Iterable, Iterator

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.docs.documents import BaseDoc
from ur.launchfile.world import World
from ur.source.diagnostic import UserError
from ur.source.file import SourceFile
from ur.source.section import Section, parse_section

_BASE = "$(arg robot_base)"
_PIECE = re.compile(r"\$\([^)]{0,500}\)")
_FIND = re.compile(r"\$\(find\s+([^\s)]+)\s*\)")
_COMPARED = re.compile(
    r"""\brobot_base['")\s]*(?:==|!=)\s*['"](\w+)['"]|['"](\w+)['"]\s*(?:==|!=)[\s("'arg]*robot_base\b"""
)
_NAME = re.compile(r"\w+\Z")


def read_base(path: str, name: str, world: World) -> BaseDoc:
    """Read a base file; an invalid one results in an empty description."""
    try:
        whole = parse_section(SourceFile(path, world.read_bytes(path).decode("utf-8", "replace")), "a base file")
        summary = whole.text("summary", "")
        variants = dict(whole.section("variants").subsections()) if whole.has("variants") else {}
        plain = whole.without("variants")
        return BaseDoc(
            name,
            summary,
            _features(plain),
            tuple((variant, _features(plain.merged(overlay))) for variant, overlay in variants.items()),
        )
    except (UserError, OSError):
        return BaseDoc(name, "", (), ())


def _features(base: Section) -> tuple[str, ...]:
    sensors = base.optional_section("sensors")
    return (*(sensors.keys if sensors else ()), *(("battery",) if base.has("battery") else ()))


def find_lacks(needs: Iterable[str], features: Iterable[str]) -> tuple[str, ...]:
    """Return the needs that features do not meet; a need may name alternatives: `lidar|raspicam`."""
    there = set(features)
    return tuple(need for need in needs if not there & set(need.split("|")))


def infer_bases(views: Iterable[LaunchView]) -> tuple[str, ...]:
    """Return the bases of files whose package has none: from the names of files and from compared values."""
    found: set[str] = set()
    for view in views:
        if "robot_base" not in view.declared:
            continue
        for element, _ in walk_elements(view.tree.launch):
            for name, value in element.attributes.items():
                found.update(_from_comparison(value))
                if name in ("file", "textfile", "command") and _BASE in value:
                    found.update(list_choices(value, _BASE, view))
    return tuple(sorted(found))


def _from_comparison(value: str) -> Iterator[str]:
    if "robot_base" in value:
        for left, right in _COMPARED.findall(value):
            yield left or right


def list_choices(written: str, piece: str, view: LaunchView) -> Iterator[str]:
    """Yield the values of a piece of a path for which a file or folder exists; other pieces may be anything."""
    yield from match_paths(written, view, until=piece)


def match_paths(written: str, view: LaunchView, until: str = "") -> list[str]:
    """Return the files that a written path may refer to with any arguments; with `until`, its texts."""
    start, names = _start_of(written, view)
    if start is None:
        return []
    found: dict[str, None] = {}
    _match(start, names, view.world, until, found)
    return list(found)


def _start_of(written: str, view: LaunchView) -> tuple[str | None, list[str]]:
    own = view.path.rpartition("/")[0]
    text = written.replace("$(dirname)", own)
    find = _FIND.match(text)
    if find:
        text = view.world.find_package(find.group(1)) + text[find.end() :]
    elif not text.startswith(("/", "$")):
        text = f"{own}/{text}"
    if not text.startswith("/"):
        return None, []
    names = text.split("/")[1:]
    fixed = 0
    while fixed < len(names) and "$(" not in names[fixed]:
        fixed += 1
    return view.world.absolute("/" + "/".join(names[:fixed])), names[fixed:]


def _match(folder: str, names: list[str], world: World, until: str, found: dict[str, None]) -> None:
    if not names:
        if not until and world.is_file(folder):
            found[folder] = None
        return
    name, rest = names[0], names[1:]
    if "$(" not in name:
        _match(f"{folder}/{name}", rest, world, until, found)
        return
    group = "(.+)"
    pattern = re.compile("".join(_pattern_of(name, until, group)) + r"\Z")
    for entry in world.list_folder(folder):
        match = pattern.match(entry)
        if match is None or entry.startswith("."):
            continue
        if until and until in name:
            choice = match.group(1)
            if _NAME.match(choice) and (not rest or _exists(f"{folder}/{entry}", rest, until, choice, world)):
                found[choice] = None
        else:
            _match(f"{folder}/{entry}", rest, world, until, found)


def _pattern_of(name: str, until: str, group: str) -> Iterator[str]:
    position = 0
    for piece in _PIECE.finditer(name):
        yield re.escape(name[position : piece.start()])
        yield group if piece.group() == until else "(?:.+)"
        position = piece.end()
    yield re.escape(name[position:])


def _exists(folder: str, names: list[str], until: str, choice: str, world: World) -> bool:
    found: dict[str, None] = {}
    _match(folder, [name.replace(until, choice) for name in names], world, "", found)
    return bool(found)
