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
_CALLED = re.compile(r"(?<!\w)(\w+)\s*\(")
_COMPUTED = re.compile(  # what may install more
    r"foreach|add_subdirectory|macro|function|configure_file|add_custom_command|include|install_.+|.*xacro.*"
)
_KEYWORD = re.compile(
    "DESTINATION|RENAME|PATTERN|FILES_MATCHING|REGEX|PERMISSIONS|COMPONENT|OPTIONAL|CONFIGURATIONS|TYPE|"
    "USE_SOURCE_PERMISSIONS|FILE_PERMISSIONS|DIRECTORY_PERMISSIONS|MESSAGE_NEVER"
)
_LONGEST = 100_000  # characters of the words of a call, or of a value
_ROOTS = ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR", "CMAKE_CURRENT_LIST_DIR")


class Rule(NamedTuple):
    """A file, or a folder with the files of some patterns, that is installed at a path below the share folder."""

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
    complete = not any(_COMPUTED.fullmatch(name) for name in {each.lower() for each in _CALLED.findall(text)})
    for call in _CALL.finditer(text):
        name = call[1].lower()
        words, is_known = _expand(call[2], known)
        if name == "set":
            known.pop(call[2].split()[0] if call[2].split() else "", None)
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
        if sum(map(len, words)) > _LONGEST:
            return [], False
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
    for word in (each for each in words[1:end] if "${" not in each):
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
        return _read_data_files(tree, text, package, find)
    except (SyntaxError, ValueError, RecursionError):
        return InstallRules((), complete=False)


def _read_data_files(tree: ast.Module, text: str, package: str, find: Find) -> InstallRules:
    values = _Values(tree, find)
    keywords = (each for node in ast.walk(tree) if isinstance(node, ast.Call) for each in node.keywords)
    given = next((each.value for each in keywords if each.arg == "data_files"), None)
    if isinstance(given, ast.Name):
        given = values.written.get(given.id)
    complete = re.search(r"data_files\s*(?:\+=|\.)", text) is None
    rules: list[Rule] = []
    for item in given.elts if isinstance(given, (ast.List, ast.Tuple)) else ():
        pair = item.elts if isinstance(item, ast.Tuple) and len(item.elts) == 2 else None
        target, sources = map(values.evaluate, pair) if pair else (None, None)
        if not isinstance(target, str) or not isinstance(sources, list):
            complete = False
        elif f"{posixpath.normpath(target)}/".startswith(f"share/{package}/"):
            below = posixpath.normpath(target)[len(f"share/{package}/") :]
            rules += [Rule(posixpath.join(below, posixpath.basename(each)), each) for each in sources]
    return InstallRules(tuple(rules), complete and bool(rules))


class _Values:
    """Values of expressions that are texts or lists of texts; None for any other. A variable is computed once."""

    def __init__(self, tree: ast.Module, find: Find) -> None:
        self._find = find
        self._known: dict[str, str | list[str] | None] = {}
        self.written: dict[str, ast.expr] = {}
        for statement in tree.body:
            if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
                self.written[statement.targets[0].id] = statement.value

    def evaluate(self, node: ast.expr) -> str | list[str] | None:
        """Return the value of an expression."""
        value = self._evaluate(node)
        return None if value is not None and len(value) > _LONGEST else value

    def _evaluate(self, node: ast.expr) -> str | list[str] | None:
        match node:
            case ast.Constant(value=str(text)):
                return text
            case ast.Name(id=name) if name in self.written:
                if name not in self._known:
                    self._known[name] = None  # where it needs itself
                    self._known[name] = self.evaluate(self.written[name])
                return self._known[name]
            case ast.List(elts=inner) | ast.Tuple(elts=inner):
                return self._texts(inner)
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                first, last = self.evaluate(left), self.evaluate(right)
                if isinstance(first, str) and isinstance(last, str):
                    return first + last
                return first + last if isinstance(first, list) and isinstance(last, list) else None
            case ast.JoinedStr(values=inner):
                parts = self._texts([each.value if isinstance(each, ast.FormattedValue) else each for each in inner])
                return None if parts is None else "".join(parts)
            case ast.Call(func=function, args=arguments) if arguments and (words := self._texts(arguments)):
                name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
                return (
                    posixpath.join(*words) if name == "join" else list(self._find(words[0])) if name == "glob" else None
                )
        return None

    def _texts(self, nodes: Iterable[ast.expr]) -> list[str] | None:
        found = [self.evaluate(each) for each in nodes]
        texts = [each for each in found if isinstance(each, str)]
        return texts if len(texts) == len(found) else None
