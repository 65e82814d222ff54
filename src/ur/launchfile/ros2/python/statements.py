"""Statements of Python: what the syntax tree says of them, and the exceptions by which they end functions and loops."""

import ast
import copy
from collections.abc import Iterator

_MOST_KEPT = 200_000  # characters: their trees take some 20 MB, those of odd files five times as much
_kept: dict[str, ast.Module] = {}


def parse_text(text: str) -> ast.Module:
    """Return the syntax tree of a text; it must not be changed. Raises the exceptions of `ast.parse`.

    Trees are kept for the next reader of the same text: an editor and `ur check` read the same files again and again.
    """
    tree = _kept.pop(text, None) or ast.parse(text)
    _kept[text] = tree
    size = sum(map(len, _kept))
    while size > _MOST_KEPT:
        size -= len(first := next(iter(_kept)))
        del _kept[first]
    return tree


class Returned(Exception):  # noqa: N818 - ends a function
    """The value of a function."""

    def __init__(self, value: object) -> None:
        super().__init__()
        self.value = value


class LoopEnd(Exception):  # noqa: N818 - ends a loop, or a round of it
    """The end of a loop, or of a round of it: `again`."""

    def __init__(self, *, again: bool) -> None:
        super().__init__()
        self.again = again


def assigns_names(statement: ast.stmt) -> bool:
    """Return whether a statement assigns names only: those are not known, and all the rest is."""
    targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
    is_assignment = isinstance(statement, ast.Assign | ast.AnnAssign | ast.AugAssign)
    return is_assignment and all(isinstance(each, ast.Name | ast.Tuple | ast.List) for each in targets)


def reading_of(target: ast.expr) -> ast.expr:
    """Return the expression that reads what a target assigns."""
    copied = copy.copy(target)
    copied.ctx = ast.Load()  # type: ignore[attr-defined]
    return copied


def decorator_name(node: ast.expr) -> str:
    """Return the last name of a decorator."""
    node = node.func if isinstance(node, ast.Call) else node
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def walk_here(statement: ast.stmt) -> Iterator[ast.AST]:
    """Yield all parts of a statement, without those of functions and classes inside."""
    waiting: list[ast.AST] = [statement]
    while waiting:
        node = waiting.pop()
        yield node
        inner = isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Lambda, ast.AsyncFunctionDef))
        if not inner or node is statement:
            waiting.extend(ast.iter_child_nodes(node) if not inner else [])


def is_generator(function: ast.FunctionDef | ast.Lambda) -> bool:
    """Return whether a function yields."""
    body = [] if isinstance(function, ast.Lambda) else function.body
    return any(isinstance(part, ast.Yield | ast.YieldFrom) for each in body for part in walk_here(each))


def assigned_names(statement: ast.stmt) -> Iterator[str]:
    """Yield the names that a statement gives a value, also those of a class, a function or an import."""
    if isinstance(statement, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
        yield statement.name
        return
    for node in walk_here(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.alias):
            yield node.asname or node.name.partition(".")[0]


def extended_names(statement: ast.stmt) -> Iterator[str]:
    """Yield the names whose lists a statement makes longer."""
    for node in walk_here(statement):
        if isinstance(node, ast.Attribute) and node.attr in ("append", "extend") and isinstance(node.value, ast.Name):
            yield node.value.id


def written_attributes(statement: ast.stmt) -> Iterator[tuple[str, str]]:
    """Yield names with their attributes that a statement may assign or call."""
    parts = list(walk_here(statement))
    called = {id(each.func) for each in parts if isinstance(each, ast.Call)}
    for node in parts:
        if (
            isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and (isinstance(node.ctx, ast.Store) or id(node) in called)
        ):
            yield node.value.id, node.attr


def word_of(statement: ast.stmt) -> str:
    """Return the word with which a statement begins, for messages."""
    return {"ClassDef": "class", "AsyncFunctionDef": "async def", "Match": "match"}.get(
        type(statement).__name__, type(statement).__name__.lower()
    )
