"""Classes of the launch API, as a Python launch file calls them: which arguments they accept, and where these are."""

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from ur.launchfile.ros2.api import Signature
from ur.launchfile.ros2.model import DescriptionProblem, Made
from ur.source.file import Span
from ur.source.suggest import did_you_mean


class CallPlaces(Mapping[str, Span]):
    """Positions of the arguments of a call, by their names. `find` returns one when it is asked for."""

    __slots__ = ("_find", "_node", "_positional")

    def __init__(self, node: ast.Call, positional: tuple[str, ...], find: Callable[[ast.AST], Span]) -> None:
        self._node, self._positional, self._find = node, positional, find

    def find_function(self) -> Span:
        """Return where the function is written."""
        return self._find(self._node.func)

    def find_argument(self, index: int) -> Span:
        """Return where an argument without a name is written."""
        return self._find(self._node.args[min(index, len(self._node.args) - 1)])

    def find_name(self, name: str) -> Span:
        """Return where the name of an argument is written."""
        for keyword in self._node.keywords:
            if keyword.arg == name:
                whole = self._find(keyword)
                return Span(whole.file, whole.start, whole.start + len(name))
        return self.find_function()

    def __getitem__(self, name: str) -> Span:
        for known, node in zip(self._positional, self._node.args, strict=False):
            if known == name:
                return self._find(node)
        for keyword in self._node.keywords:
            if keyword.arg == name:
                return self._find(keyword.value)
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        named = [keyword.arg for keyword in self._node.keywords if keyword.arg is not None]
        return iter(dict.fromkeys([*named, *self._positional[: len(self._node.args)]]))

    def __len__(self) -> int:
        return len(list(iter(self)))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ApiClass:
    """A class of the launch API."""

    signature: Signature

    def make(
        self,
        arguments: list[object],
        keywords: dict[str, object],
        node: ast.Call,
        find: Callable[[ast.AST], Span],
        report: Callable[[DescriptionProblem], None],
    ) -> Made:
        """Return an object that a call makes; wrong arguments are reported, and left out."""
        signature = self.signature
        values, positional, kind = keywords, signature.positional, signature.kind
        wrong = [] if keywords.keys() <= signature.keywords else [k for k in keywords if k not in signature.keywords]
        if positional and positional[0].startswith("*"):
            values[positional[0][1:]], arguments, positional = arguments, [], ()
        places = CallPlaces(node, positional, find)
        for index, value in enumerate(arguments):
            if index >= len(positional):
                few = f"at most {len(positional)}" if positional else "none"
                message = f"{kind} has {len(arguments)} arguments without a name, expected {few}"
                report(DescriptionProblem(message, "launch-argument", places.find_argument(index), None, kind))
                break
            values[positional[index]] = value
        for name in wrong:
            report(self._wrong_keyword(name, places.find_name(name)))
            present = signature.removed.get(name)
            value = values.pop(name)
            if present:
                values.setdefault(present, value)
        if not signature.required <= values.keys():
            missing = sorted(signature.required - values.keys())
            expected = "it" if len(missing) == 1 else "them"
            message = f"{kind} has no {' and no '.join(missing)}, expected {expected}"
            report(DescriptionProblem(message, "launch-argument", places.find_function(), None, kind))
        return Made(kind, values, places.find_function, places)

    def _wrong_keyword(self, name: str, span: Span) -> DescriptionProblem:
        signature = self.signature
        present = signature.removed.get(name) or did_you_mean(name, signature.keywords)
        was = "was removed from" if name in signature.removed else "is not an argument of"
        known = ", ".join(sorted(signature.keywords)) or "none"
        help_ = f"write {present}=" if present else f"it has: {known}"
        message = f"'{name}' {was} {signature.kind}, expected one that it has"
        return DescriptionProblem(message, "launch-argument", span, help_, name)
