"""Facts of Python files that the rules of form need: each file is read, parsed and walked once.

The trees of all files take half a gigabyte, so the rules get values and no trees.
"""

import ast
import gc
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

ROOT = Path(__file__).parents[2]
FOLDERS = ("src", "tests", "bench", "tools")

Function = ast.FunctionDef | ast.AsyncFunctionDef
N = TypeVar("N", bound=ast.AST)

OPENERS = {"open", "read_text", "read_bytes", "fromfile", "memmap"}
PARSERS = {
    *(f"yaml.{name}" for name in ("load", "safe_load", "load_all", "safe_load_all", "full_load", "unsafe_load")),
    *(f"{module}.{name}" for module in ("ElementTree", "ET") for name in ("fromstring", "parse", "iterparse", "XML")),
    *("json.load", "np.load", "numpy.load", "tarfile.open", "zipfile.ZipFile", "Image.open", "shutil.unpack_archive"),
}
JSON_PARSERS = {"json.load", "json.loads", "JSONDecoder", "json.JSONDecoder"}
PATCHES = ("monkeypatch.setattr", "monkeypatch.delattr", "mock.patch", "patch.object", "mocker.patch")
THREADS = {
    "threading": {"Barrier", "BoundedSemaphore", "Condition", "Event", "Lock", "RLock", "Semaphore", "Thread", "Timer"},
    "queue": {"LifoQueue", "PriorityQueue", "Queue", "SimpleQueue"},
    "rospy": {"Timer"},
    "futures": {"ThreadPoolExecutor"},
}
# Objects with the methods of the reader (ur.source.foreign), and objects whose `open` opens no file.
_READERS = {
    *("context.world", "self._context.world"),
    *("world", "self.world", "self._world", "workspace.world", "draft.world", "cached"),
    *("self.sources", "session.sources"),
}
_NO_FILE = re.compile(r"(self|self\._end)$|.*query_one|.*(_monitor|_outputs|listener)$")
# A file of the kernel, a device, or a file of the own package; and flags with which nothing is read.
_KNOWN_FILE = re.compile(r"""['"]/(proc|sys|dev)/|os\.devnull|\bfiles\(|\b__file__\b""")
_READS_NOTHING = re.compile(r"\bO_(WRONLY|CREAT|DIRECTORY|PATH)\b")
_WRITES = re.compile(r"[wax]")


@dataclass(frozen=True, slots=True)
class Import:
    """An import of a module, or of names from it (relative ones begin with '.').

    `kind` is `at the top`, `in a function` or `for types`.
    """

    module: str
    names: tuple[str, ...]
    kind: str


@dataclass(frozen=True, slots=True)
class Body:
    """A function: its lines, and its arguments and statements as a text without name, docstring and comments.

    Methods and functions in functions are nested.
    """

    name: str
    lines: int
    text: str
    is_nested: bool


@dataclass(frozen=True, slots=True)
class Facts:
    """Facts of one file. `opened` are calls that open or parse a file without the limits of the reader."""

    lines: int
    code_lines: int
    imports: tuple[Import, ...]
    names: frozenset[str]
    public_names: frozenset[str]
    """Of classes, functions, methods and their parameters."""
    docstrings: tuple[str, ...]
    functions: tuple[Body, ...]
    methods: tuple[tuple[str, bool], ...]
    """Public methods of public classes, and whether each has a docstring."""
    opened: tuple[str, ...]
    reads_json: bool
    makes_threads: bool
    ssh_commands: tuple[str, ...]
    lines_with_any: int
    patches: int
    only_protocols: bool


def read_facts(root: Path = ROOT) -> dict[str, Facts]:
    """Return the facts of all Python files, also of programs without a suffix, by their paths below `root`."""
    texts = {path.relative_to(root).as_posix(): text for path, text in read_texts(root) if is_python(path, text)}
    gc.disable()  # trees hold no circles, and are dropped one by one
    try:
        return {name: find_facts(text) for name, text in texts.items()}
    finally:
        gc.enable()


def read_texts(root: Path) -> Iterator[tuple[Path, str]]:
    """Return Python, shell and JavaScript files of FOLDERS, also programs without a suffix, with their texts."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".py", ".bash", ".sh", ".js") and "node_modules" not in path.parts:
                yield path, path.read_text(encoding="utf-8")
            elif not path.suffix and path.is_file():
                with path.open("rb") as file:
                    begins = file.read(2)
                if begins == b"#!":
                    yield path, path.read_text(encoding="utf-8")


def is_python(path: Path, text: str) -> bool:
    """Return whether a file is a Python module or program."""
    return path.suffix == ".py" or (not path.suffix and "python" in text.partition("\n")[0])


def find_facts(text: str) -> Facts:
    """Parse a module and return its facts."""
    tree = ast.parse(text)
    nodes = _walk(tree)
    documented = [tree, *_of(nodes, ast.ClassDef), *_functions(nodes)]
    docstrings = {id(node): found for node in documented if (found := _docstring(node)) is not None}
    calls = [(dotted(node.func), node) for node in _of(nodes, ast.Call)]
    lines = text.removesuffix("\n").split("\n") if text else []  # as Python counts them
    top = {id(each) for each in tree.body}
    return Facts(
        lines=len(lines),
        code_lines=_count_code(lines, docstrings.values(), nodes),
        imports=tuple(_imports(tree.body, "at the top")),
        names=frozenset(_names(nodes)),
        public_names=frozenset(_public_names(tree)),
        docstrings=tuple(str(each.value) for each in docstrings.values() if str(each.value).strip()),
        functions=tuple(_body(each, lines, id(each) not in top, id(each) in docstrings) for each in _functions(nodes)),
        methods=tuple((each.name, id(each) in docstrings) for each in _public_methods(tree)),
        opened=tuple(f"{node.lineno}: {ast.unparse(node)[:80]}" for name, node in calls if _opens(name, node)),
        reads_json=any(name in JSON_PARSERS for name, _ in calls),
        makes_threads=_makes_threads(tree, nodes),
        ssh_commands=tuple(ast.unparse(each) for each in _of(nodes, ast.List) if _is_ssh(each))
        if "ssh" in text
        else (),
        lines_with_any=len({*_lines_of_any(nodes)}),
        patches=sum(name.startswith(PATCHES) for name, _ in calls),
        only_protocols=_has_only_protocols(tree),
    )


Nodes = Mapping[type[ast.AST], list[ast.AST]]


_PLAIN = {"ctx", "op", "ops", "id", "attr", "arg", "name", "asname", "module", "level", "kind", "type_comment"}
"""Fields of nodes that hold no nodes which a rule reads."""


class _Fields(dict[type, tuple[str, ...]]):
    """The fields of each type of node that may hold nodes."""

    def __missing__(self, key: type) -> tuple[str, ...]:
        names: tuple[str, ...] = () if key is ast.Constant else getattr(key, "_fields", ())
        found = self[key] = tuple(name for name in names if name not in _PLAIN)
        return found


_FIELDS = _Fields()


def _walk(tree: ast.Module) -> Nodes:
    """Return the nodes of a tree by type."""
    nodes: dict[type[ast.AST], list[ast.AST]] = defaultdict(list)
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        kind = type(node)
        nodes[kind].append(node)
        for name in _FIELDS[kind]:
            value = getattr(node, name)
            if type(value) is list:
                waiting += value
            elif value is not None:
                waiting.append(value)
    return nodes


def _imports(body: Iterable[ast.AST], kind: str) -> Iterator[Import]:
    for node in body:
        if isinstance(node, ast.Import):
            yield from (Import(alias.name, (), kind) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield Import("." * node.level + (node.module or ""), tuple(alias.name for alias in node.names), kind)
        else:
            inner = kind
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                inner = "in a function"
            elif isinstance(node, ast.If) and "TYPE_CHECKING" in dotted(node.test):
                inner = "for types"
            for name in ("body", "orelse", "finalbody", "handlers", "cases"):
                if isinstance(value := getattr(node, name, None), list):
                    yield from _imports(value, inner)


def _of(nodes: Nodes, kind: type[N]) -> list[N]:
    found: list[N] = nodes.get(kind, [])  # type: ignore[assignment] # the walk sorts them by type
    return found


def _functions(nodes: Nodes) -> list[Function]:
    return sorted([*_of(nodes, ast.FunctionDef), *_of(nodes, ast.AsyncFunctionDef)], key=lambda each: each.lineno)


def dotted(node: ast.expr) -> str:
    """Return a name with its owners, like `os.path.join`, as it is written."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return ast.unparse(node)


def _docstring(node: ast.Module | ast.ClassDef | Function) -> ast.Constant | None:
    first = node.body[0] if node.body else None
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
        return first.value
    return None


def _public_methods(tree: ast.Module) -> Iterator[Function]:
    for each in tree.body:
        if isinstance(each, ast.ClassDef) and not each.name.startswith("_"):
            for method in each.body:
                if isinstance(method, ast.FunctionDef | ast.AsyncFunctionDef) and not method.name.startswith("_"):
                    yield method


def _public_names(tree: ast.Module | ast.ClassDef) -> Iterator[str]:
    for each in tree.body:
        if isinstance(each, ast.ClassDef) and not each.name.startswith("_"):
            yield from (each.name, *_public_names(each))
        elif isinstance(each, ast.FunctionDef | ast.AsyncFunctionDef) and not each.name.startswith("_"):
            yield each.name
            yield from (each.arg for each in (*each.args.posonlyargs, *each.args.args, *each.args.kwonlyargs))


def _names(nodes: Nodes) -> Iterator[str]:
    """Return the names that a module gives: of functions, classes, arguments and variables."""
    yield from (each.name for each in (*_of(nodes, ast.ClassDef), *_functions(nodes)))
    yield from (each.arg for each in _of(nodes, ast.arg))
    yield from (each.id for each in _of(nodes, ast.Name) if isinstance(each.ctx, ast.Store))
    yield from (each.attr for each in _of(nodes, ast.Attribute) if isinstance(each.ctx, ast.Store))


def _body(node: Function, lines: list[str], is_nested: bool, has_docstring: bool) -> Body:
    end = node.end_lineno or node.lineno
    statements = node.body[1:] if has_docstring else node.body
    text = ""
    if statements:
        stripped = [line.strip() for line in lines[statements[0].lineno - 1 : end]]
        text = "\n".join([ast.unparse(node.args), *(line for line in stripped if line and line[0] != "#")])
    return Body(node.name, end - node.lineno + 1, text, is_nested)


def _count_code(lines: list[str], docstrings: Iterable[ast.Constant], nodes: Nodes) -> int:
    """Count lines without blank ones, comments and docstrings; a text over several lines counts."""
    code = {number for number, line in enumerate(lines, 1) if (begin := line.lstrip()[:1]) and begin != "#"}
    for node in (*_of(nodes, ast.Constant), *_of(nodes, ast.JoinedStr)):
        if (node.end_lineno or 0) > node.lineno:
            code |= set(range(node.lineno, (node.end_lineno or 0) + 1))
    for each in docstrings:
        code -= set(range(each.lineno, (each.end_lineno or 0) + 1))
    return len(code)


def _opens(name: str, node: ast.Call) -> bool:
    """Return whether a call reads a file that is not known to be the kernel's or of the own package."""
    owner, _, last = name.rpartition(".")
    if name not in PARSERS and name != "open":
        if not owner or last not in OPENERS or owner in _READERS or _NO_FILE.match(owner):
            return False
        if last == "open" and not node.args and not node.keywords:  # a panel, a connection
            return False
    if _KNOWN_FILE.search(ast.unparse(node)):
        return False
    if name == "os.open":
        return not _READS_NOTHING.search(ast.unparse(node))
    modes = [each.value for each in node.keywords if each.arg == "mode"]
    modes += node.args[0:1] if last == "open" and owner and name not in PARSERS else node.args[1:2]
    return not any(isinstance(each, ast.Constant) and _WRITES.match(str(each.value)) for each in modes)


def _makes_threads(tree: ast.Module, nodes: Nodes) -> bool:
    """Return whether a module makes locks or threads, or hands them on to be made; annotations do not count."""
    known = {
        alias.asname or alias.name
        for node in _of(nodes, ast.ImportFrom)
        for alias in node.names
        if alias.name in THREADS.get(str(node.module).rpartition(".")[2], ())
    }
    if not known and not any(alias.name.split(".")[-1] in THREADS for e in _of(nodes, ast.Import) for alias in e.names):
        return False
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name) and node.id in known:
            return True
        if isinstance(node, ast.Attribute) and node.attr in THREADS.get(dotted(node.value), ()):
            return True
        for name, value in ast.iter_fields(node):
            if name not in ("annotation", "returns"):
                waiting += [
                    each for each in (value if isinstance(value, list) else [value]) if isinstance(each, ast.AST)
                ]
    return False


def _is_ssh(node: ast.List) -> bool:
    return any(isinstance(each, ast.Constant) and each.value == "ssh" for each in node.elts)


def _lines_of_any(nodes: Nodes) -> Iterator[int]:
    yield from (each.lineno for each in _of(nodes, ast.Name) if each.id == "Any")
    yield from (each.lineno for each in _of(nodes, ast.Attribute) if each.attr == "Any")
    yield from (each.lineno for each in _of(nodes, ast.alias) if each.name == "Any")


def _has_only_protocols(tree: ast.Module) -> bool:
    classes = [each for each in tree.body if isinstance(each, ast.ClassDef)]
    functions = [each for each in tree.body if isinstance(each, ast.FunctionDef | ast.AsyncFunctionDef)]
    return bool(classes) and not functions and all(any("Protocol" in ast.unparse(e) for e in c.bases) for c in classes)
