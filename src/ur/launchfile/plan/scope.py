"""The scope of a position in a launch file: namespace, arguments, remaps, environment, `~` parameters."""

from __future__ import annotations

from ur.launchfile.plan.names import join_names, make_namespace
from ur.launchfile.plan.specs import ParamSpec
from ur.launchfile.syntax import Element
from ur.source.file import Span


class Scope:
    """One level of nesting. It mirrors roslaunch's LoaderContext, including its quirks, and is modified by its tags.

    While the children of an `<include>` are read, `passing` collects the arguments for the file and `args` still has
    the including file's; `start_file` swaps them.
    """

    __slots__ = (
        "anonymous",
        "args",
        "chain",
        "declared",
        "env",
        "filename",
        "handed_over",
        "missing",
        "namespace",
        "params",
        "parent",
        "pass_all_args",
        "passing",
        "poisoned",
        "remaps",
    )

    def __init__(self, namespace: str, filename: str, args: dict[str, str]) -> None:
        self.parent: Scope | None = None
        self.namespace = namespace
        self.filename = filename
        self.args = args
        self.anonymous: dict[str, str] = {}
        self.declared: dict[str, Element] = {}
        self.missing: dict[str, Element] = {}  # required arguments that were not passed, until one is used
        self.poisoned: set[str] = set()  # arguments whose value could not be found out; reported already
        self.passing: dict[str, str] | None = None
        self.handed_over: tuple[str, ...] = ()
        self.pass_all_args = False
        self.remaps: list[tuple[str, str]] = []
        self.env: list[tuple[str, str]] = []
        self.params: list[ParamSpec] = []
        self.chain: tuple[Span, ...] = ()

    def child(self, namespace: str | None) -> Scope:
        """Return the scope of a `<group>` or `<include>`. Raises ValueError if the namespace is a private name."""
        child = Scope(self.child_namespace(namespace), self.filename, dict(self.args))
        child.parent = self
        child.anonymous = dict(self.anonymous)
        child.declared = dict(self.declared)
        child.missing = dict(self.missing)
        child.poisoned = set(self.poisoned)
        child.env = self.env[:]
        # As in roslaunch, a list that is not empty is shared, so that additions of an include are visible after it.
        child.params = self.params or []
        child.chain = self.chain
        return child

    def include_child(self) -> Scope:
        """Return the scope of an `<include>`: without arguments, everything else inherited."""
        child = self.child(None)
        child.declared = {}
        child.missing = {}
        child.passing = {}
        return child

    def child_namespace(self, namespace: str | None) -> str:
        """Return the full namespace of a child. Raises ValueError for a private name."""
        if not namespace:
            return self.namespace
        return make_namespace(namespace if namespace[0] == "/" else join_names(self.namespace, namespace))

    def start_file(self, filename: str, include: Span) -> None:
        """Switch from the `<include>` tag to the included file."""
        passed = self.passing or {}
        self.handed_over = tuple(passed)
        self.args = passed
        self.passing = None
        self.anonymous = {}
        self.declared = {}
        self.filename = filename
        self.chain = (*self.chain, include)

    def add_param(self, param: ParamSpec) -> None:
        """Add a `~` parameter for the nodes that follow. A name that is set again moves to the end."""
        for known in self.params:
            if known.name == param.name:
                self.params.remove(known)
                break
        self.params.append(param)

    def add_remap(self, remap: tuple[str, str]) -> None:
        """Add a remap for the nodes that follow."""
        self.remaps = [known for known in self.remaps if known[0] != remap[0]]
        self.remaps.append(remap)

    def all_remaps(self) -> list[tuple[str, str]]:
        """Return the effective remaps: outer ones first, without those that an inner one replaces."""
        if self.parent is None:
            return self.remaps[:]
        own = {source for source, _ in self.remaps}
        return [remap for remap in self.parent.all_remaps() if remap[0] not in own] + self.remaps
