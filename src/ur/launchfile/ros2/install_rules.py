"""Install rules of a package in source form: which file of its source tree has a path in the share folder.

Read are `install(...)` and `ament_auto_package(INSTALL_TO_SHARE ...)` of CMake, and `data_files` of setup.py. What
they compute otherwise makes the rules incomplete.
"""

import ast
import posixpath
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from fnmatch import fnmatchcase
from typing import NamedTuple

Find = Callable[[str], Iterable[str]]
"""Returns the files that a pattern of `glob` names, relative to the source tree."""

_CALL = re.compile(r"(?i)\b(install|ament_auto_package|set|file)\s*\(([^()]*)\)")
_WORDS = re.compile(r'"([^"]*)"|([^\s"]+)')
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_COMPUTED = re.compile(  # what may install more
    r"(?i)\b(?:foreach|add_subdirectory|macro|function|configure_file|add_custom_command|include|install_\w+|\w*xacro\w*)\s*\("
)
_KEYWORD = re.compile(
    "DESTINATION|RENAME|PATTERN|FILES_MATCHING|REGEX|PERMISSIONS|COMPONENT|OPTIONAL|CONFIGURATIONS|TYPE|"
    "USE_SOURCE_PERMISSIONS|FILE_PERMISSIONS|DIRECTORY_PERMISSIONS|MESSAGE_NEVER"
)
_ROOTS = ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR", "CMAKE_CURRENT_LIST_DIR")


class Rule(NamedTuple):
    """What is installed at a path below the share folder: a file, or a folder with the files of some patterns."""

    target: str
    source: str
    is_folder: bool = False
    patterns: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()


class InstallRules(NamedTuple):
    """The rules of a package. `complete`: nothing else is installed into its share folder."""

    rules: tuple[Rule, ...]
    complete: bool

    def find(self, path: str) -> Iterator[str]:
        """Yield the paths in the source tree of what would be installed at a path below the share folder."""
        for rule in self.rules:
            if rule.is_folder and (not rule.target or path.startswith(f"{rule.target}/")):
                inner = path[len(rule.target) :].lstrip("/")
                name = posixpath.basename(path)
                parts = inner.split("/")
                fits = not rule.patterns or any(fnmatchcase(name, each) for each in rule.patterns)
                if fits and not any(fnmatchcase(part, each) for part in parts for each in rule.excluded):
                    yield posixpath.normpath(f"{rule.source}/{inner}")
            elif path == rule.target:
                yield rule.source


def read_cmake(text: str, package: str, find: Find) -> InstallRules:
    """Read the rules of a CMakeLists.txt."""
    text = re.sub(r"#[^\n]*", "", text)
    known = {"PROJECT_NAME": package, "CMAKE_INSTALL_PREFIX": "", "CMAKE_INSTALL_DATADIR": "share"}
    known |= dict.fromkeys(_ROOTS, ".")
    rules: list[Rule] = []
    complete = _COMPUTED.search(text) is None
    for call in _CALL.finditer(text):
        name = call[1].lower()
        words, is_known = _expand(call[2], known)
        if name == "set":
            known |= {words[0]: ";".join(words[1:])} if words and is_known else {}
        elif name == "file":
            if len(words) > 2 and words[0].startswith("GLOB"):
                patterns = [each for each in words[2:] if each not in ("CONFIGURE_DEPENDS", "RELATIVE", ".")]
                known[words[1]] = ";".join(path for each in patterns for path in find(posixpath.normpath(each)))
        elif name == "install":
            complete = complete and (is_known or words[:1] == ["TARGETS"])
            rules += _read_install(words, package)
        elif "INSTALL_TO_SHARE" in words:
            folders = words[words.index("INSTALL_TO_SHARE") + 1 :]
            rules += [Rule(posixpath.basename(each.rstrip("/")), each.rstrip("/"), is_folder=True) for each in folders]
    return InstallRules(tuple(rules), complete and bool(rules))


def _expand(text: str, known: Mapping[str, str]) -> tuple[list[str], bool]:
    """Return the words of a call, and whether all of its variables are known."""
    words: list[str] = []
    is_known = True
    for quoted, plain in _WORDS.findall(text):
        word = quoted or plain
        is_known = is_known and all(name in known for name in _VARIABLE.findall(word))
        words += _VARIABLE.sub(lambda match: known.get(match[1], match[0]), word).split(";")
    return [each for each in words if each], is_known


def _read_install(words: list[str], package: str) -> Iterator[Rule]:
    kind = words[0] if words else ""
    if kind not in ("DIRECTORY", "FILES", "PROGRAMS") or "DESTINATION" not in words[:-1]:
        return
    target = posixpath.normpath(words[words.index("DESTINATION") + 1]).lstrip("/")
    if target != f"share/{package}" and not target.startswith(f"share/{package}/"):
        return
    below = target[len(f"share/{package}/") :]
    end = next((number for number, word in enumerate(words) if _KEYWORD.fullmatch(word)), len(words))
    pairs = [(words[i + 1], words[i + 2 : i + 3]) for i, word in enumerate(words[:-1]) if word == "PATTERN"]
    excluded = tuple(pattern for pattern, after in pairs if after == ["EXCLUDE"])
    wanted = tuple(pattern for pattern, _ in pairs if pattern not in excluded) if "FILES_MATCHING" in words else ()
    renamed = words[words.index("RENAME") + 1] if "RENAME" in words[:-1] else ""
    for word in words[1:end]:
        source = posixpath.normpath(word)
        if kind == "DIRECTORY":
            last = "" if word.endswith("/") else posixpath.basename(source)
            place = posixpath.join(below, last).strip("/").removesuffix(".").rstrip("/")
            yield Rule(place, source, True, wanted, excluded)
        else:
            yield Rule(posixpath.join(below, renamed or posixpath.basename(source)), source)


def read_setup(text: str, package: str, find: Find) -> InstallRules:
    """Read `data_files` of a setup.py."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError):
        return InstallRules((), complete=False)
    values: dict[str, ast.expr] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
            values[statement.targets[0].id] = statement.value
    keywords = (each for node in ast.walk(tree) if isinstance(node, ast.Call) for each in node.keywords)
    given = next((each.value for each in keywords if each.arg == "data_files"), None)
    complete = given is not None and re.search(r"data_files\s*(?:\+=|\.)", text) is None
    if isinstance(given, ast.Name):
        given = values.get(given.id)
    rules: list[Rule] = []
    for item in given.elts if isinstance(given, (ast.List, ast.Tuple)) else ():
        pair = item.elts if isinstance(item, ast.Tuple) and len(item.elts) == 2 else None
        target = _evaluate(pair[0], values, find) if pair else None
        sources = _evaluate(pair[1], values, find) if pair else None
        if not isinstance(target, str) or not isinstance(sources, list):
            complete = False
        elif f"{posixpath.normpath(target)}/".startswith(f"share/{package}/"):
            below = posixpath.normpath(target)[len(f"share/{package}/") :]
            rules += [Rule(posixpath.join(below, posixpath.basename(each)), each) for each in sources]
    return InstallRules(tuple(rules), complete and bool(rules))


def _evaluate(node: ast.expr, values: Mapping[str, ast.expr], find: Find, depth: int = 20) -> str | list[str] | None:
    """Return the value of an expression that is a text or a list of texts; None if it is not known."""
    parts: list[str | list[str] | None]
    if depth == 0:
        return None
    match node:
        case ast.Constant(value=str(text)):
            return text
        case ast.Name(id=name) if name in values:
            return _evaluate(values[name], values, find, depth - 1)
        case ast.List(elts=inner) | ast.Tuple(elts=inner):
            parts = [_evaluate(each, values, find, depth - 1) for each in inner]
            return [each for each in parts if isinstance(each, str)] if all(isinstance(p, str) for p in parts) else None
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            first, last = (_evaluate(each, values, find, depth - 1) for each in (left, right))
            if isinstance(first, str) and isinstance(last, str):
                return first + last
            return first + last if isinstance(first, list) and isinstance(last, list) else None
        case ast.JoinedStr(values=inner):
            wanted = [each.value if isinstance(each, ast.FormattedValue) else each for each in inner]
            parts = [_evaluate(each, values, find, depth - 1) for each in wanted]
            return "".join(map(str, parts)) if all(isinstance(each, str) for each in parts) else None
        case ast.Call(func=function, args=arguments):
            name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
            texts = [_evaluate(each, values, find, depth - 1) for each in arguments]
            known = [each for each in texts if isinstance(each, str)]
            if len(known) != len(texts) or not known:
                return None
            return posixpath.join(*known) if name == "join" else list(find(known[0])) if name == "glob" else None
    return None
