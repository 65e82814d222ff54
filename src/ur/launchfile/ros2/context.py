"""The state in which a description is carried out: configurations, environment, the file, and what was found."""

import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from fnmatch import fnmatchcase
from functools import partial
from typing import TYPE_CHECKING, Any

from ur.launchfile.plan.commands import RunWith
from ur.launchfile.plan.values.budget import PER_YAML_CHARACTER, Budget
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.file import Span
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from ur.launchfile.ros2.install_rules import InstallRules

MOST_INCLUDES = 2_000
MOST_FILES = 5_000
DEEPEST = 50
MOST_BYTES = 512 * 1024  # of a file in Python or YAML: its syntax tree takes 500 times as much
PER_SYSTEM_CALL = 50  # units of work
ANY_NAME = ""  # a configuration of this name is Unknown: the group hands over some that are not known


class Environment(dict[str, str]):
    """The environment variables, as `os.environ`."""

    def __init__(self, start: Mapping[str, str]) -> None:
        super().__init__(start)
        self._start = start

    def __getitem__(self, name: str) -> str:
        if name in self._start:
            self._start[name]  # which records that the variable is used
        return super().__getitem__(name)

    def __missing__(self, name: str) -> str:
        with suppress(KeyError):
            if name not in self._start:
                return self._start[name]  # also one that only the computer has on which the file is used
        help_ = (
            "set it, or give a default: the second argument of os.environ.get, default_value= of EnvironmentVariable"
        )
        message = f"environment variable '{name}' is not set, expected a value"
        raise DescriptionProblem(message, "unset-variable", None, help_, name)

    def get(self, key: str, default: Any = None) -> Any:
        """Return a variable. See os.environ."""
        known = self._start.get(key, default)
        if key in self or key in self._start:
            return dict.get(self, key, default)
        if known is None:
            with suppress(KeyError):
                return self._start[key]  # as above
        return known


class Context:
    """As upstream's LaunchContext: it changes while the entities are visited, one after the other.

    `configurations` are texts by name; `remaps`, `global_parameters` and `namespace` belong to their scope, too. `file`
    is the launch file that is being visited, reached through the includes of `chain`.
    """

    def __init__(self, world: World, budget: Budget, arguments: Mapping[str, str]) -> None:
        self.world, self.budget = world, budget
        self.configurations: dict[str, object] = dict(arguments)
        self.environment: dict[str, str] = Environment(world.environment)
        self.namespace: str | None = None
        self.global_parameters: tuple[object, ...] = ()
        self.remaps: tuple[tuple[str, str], ...] = ()
        self.variables: dict[str, object] = {}  # of loops
        self.file = ""
        self.chain: tuple[Span, ...] = ()
        self.on_problem: Callable[[DescriptionProblem, tuple[Span, ...]], None] = lambda *_: None
        self.on_value: Callable[[Made, str], None] | None = None
        self.on_gap: Callable[[Unknown, tuple[Span, ...]], None] = lambda *_: None
        self._scopes: list[tuple[dict[str, object], str | None, tuple[object, ...], tuple[tuple[str, str], ...]]] = []
        self._environments: list[dict[str, str]] = []
        self._missing: set[str] = set()
        self.modules: dict[str, object] = {}  # of Python, by their files
        self._listed: dict[str, list[tuple[str, ...]]] = {}
        self._shares: dict[str, str] = {}  # folders of packages, and their names
        self._rules: dict[str, InstallRules | None] = {}  # of packages, by their folders
        self.rewritten: dict[str, object] = {}
        """The contents of parameter files that are rewritten when the launch starts, by their paths here."""
        self.written: dict[str, object] = {}
        """Their texts, or what `str` makes a text of."""
        self.rewrites: dict[object, tuple[object, object, object]] = {}  # contents with changes: before, after, text
        self.run_command: RunWith | None = None
        """Runs what `Command` names; without it the output is not known."""
        self.used: set[str] = set()  # names of configurations that were asked for
        self.temporary = 0  # how many temporary files have a name

    @property
    def folder(self) -> str:
        """The folder of the launch file."""
        return self.file.rpartition("/")[0] or "/"

    def report(self, problem: DescriptionProblem) -> None:
        """Report a problem in the present file."""
        self.on_problem(problem, self.chain)

    def add_gap(self, unknown: Unknown) -> None:
        """Report a value that is not known."""
        self.on_gap(unknown, self.chain)

    def read(self, path: str) -> bytes:
        """Return the content of a file, which the launch may have written, charged to the budget. Raises OSError."""
        data = str(self.written[path]).encode() if path in self.written else self.world.read_bytes(path)
        self.budget.charge(len(data))
        return data

    def load_yaml(self, text: str, *, shared: bool = False) -> Any:
        """Return the value of a text in YAML, charged to the budget. Raises ValueError.

        A `shared` value must not be changed.
        """
        self.budget.charge(PER_YAML_CHARACTER * len(text))
        from ur.source.foreign import yaml_text  # many files have no YAML, and a start has to be fast

        return yaml_text.load_shared_yaml(text) if shared else yaml_text.load_yaml(text)

    def list_folder(self, path: str) -> tuple[str, ...]:
        """Return the names in a folder, charged to the budget."""
        names = self.world.list_folder(path)
        self.budget.charge(PER_SYSTEM_CALL + len(names))
        return names

    def is_file(self, path: str) -> bool:
        """Return whether a path leads to a file, charged to the budget."""
        self.budget.charge(PER_SYSTEM_CALL)
        return path in self.written or self.world.is_file(path)

    @property
    def is_scoped(self) -> bool:
        """True inside of a group at whose end configurations are forgotten."""
        return bool(self._scopes)

    def push_scope(self) -> None:
        """Begin a scope of configurations."""
        self.budget.charge(len(self.configurations))
        self._scopes.append((dict(self.configurations), self.namespace, self.global_parameters, self.remaps))

    def pop_scope(self) -> None:
        """End the last scope of configurations."""
        if self._scopes:
            known, self.namespace, self.global_parameters, self.remaps = self._scopes.pop()
            self.configurations.clear()
            self.configurations.update(known)

    def reset_scope(self) -> None:
        """Forget all configurations, and what else belongs to the scope."""
        self.configurations.clear()
        self.namespace, self.global_parameters, self.remaps = None, (), ()

    def push_environment(self) -> None:
        """Begin a scope of environment variables."""
        self.budget.charge(len(self.environment))
        self._environments.append(dict(self.environment))

    def pop_environment(self) -> None:
        """End the last scope of environment variables."""
        if self._environments:
            known = self._environments.pop()
            self.environment.clear()
            self.environment.update(known)

    def reset_environment(self) -> None:
        """Set the variables that the launch was started with."""
        self.environment.clear()
        self.environment.update(self.world.environment)

    def find_share(self, package: object, span: Span | None) -> str | Unknown:
        """Return the share folder of a package. One that is missing is reported, once."""
        if isinstance(package, Unknown):
            return package
        name = str(package)
        try:
            folder = self.world.find_package(name)
            self._shares[folder] = name
            return folder
        except (PackageNotFound, OSError, ValueError):
            pass
        if name not in self._missing:
            self._missing.add(name)
            near = did_you_mean(name, self.world.package_names())
            help_ = (
                f"did you mean {near}?"
                if near and near[0] == name[0]
                else f"install it, or build its workspace: ur get {name}"
            )
            message = f"package '{name}' is not found, expected a package of this computer"
            self.report(DescriptionProblem(message, "unknown-package", span, help_, name))
        return Unknown(f"package {name} is not installed", span, "package")

    def find_prefix(self, package: object, span: Span | None) -> str | Unknown:
        """Return the folder into which a package is installed."""
        share = self.find_share(package, span)
        if isinstance(share, Unknown):
            return share
        return share.removesuffix(f"/share/{package}")

    def keep_rewritten(self, path: str, content: object, text: object) -> str:
        """Keep the content of a rewritten file, and return its path. The launcher writes `text` into it."""
        self.rewritten[path], self.written[path] = content, text
        return path

    def near_file(self, path: str) -> str | None:
        """Return help for a file that is missing: one with nearly its name."""
        folder, _, name = path.rpartition("/")
        near = did_you_mean(name, self.list_folder(folder or "/"))
        return f"did you mean {folder}/{near}?" if near else None

    def find_file(self, path: str) -> str:
        """Return where a file of a share folder is.

        A source tree is no share folder: its install rules decide which of its files is meant. Where they are not known
        completely, a file of the same name counts, also as a template (`.in`); of several that whose path agrees most.
        """
        folder, rules = self._rules_of(path)
        if rules is None:
            return path
        inner = path[len(folder) + 1 :]
        for each in rules.find(inner):
            if self.is_file(found := f"{folder}/{each}"):
                return found
        if self.is_file(path):
            return path
        wanted = inner.split("/")
        names = (wanted[-1], f"{wanted[-1]}.in")
        others = [parts for parts in self.files_of(folder) if parts[-1] in names]
        if not others:
            return path
        return "/".join((folder, *max(others, key=lambda parts: len(set(parts) & set(wanted)))))

    def is_left_out(self, path: str) -> bool:
        """Return whether a file is in the source tree of a package, but certain not to be installed at this path."""
        folder, rules = self._rules_of(path)
        if rules is None or not rules.complete:
            return False
        return not any(self.is_file(f"{folder}/{each}") for each in rules.find(path[len(folder) + 1 :]))

    def _rules_of(self, path: str) -> "tuple[str, InstallRules | None]":
        """Return the package in whose share folder a path is, and its install rules; None if it is no source tree."""
        folder = next((each for each in self._shares if path.startswith(f"{each}/")), "")
        if folder and folder not in self._rules:
            self._rules[folder] = self._read_rules(folder)
        return folder, self._rules.get(folder)

    def _read_rules(self, folder: str) -> "InstallRules | None":
        present = [each for each in ("CMakeLists.txt", "setup.py") if each in self.list_folder(folder)]
        if not present:
            return None
        from ur.launchfile.ros2.install_rules import read_cmake, read_setup  # only for source trees

        text = self.text_of(f"{folder}/{present[0]}")[:MOST_BYTES]
        self.budget.charge(len(text))
        read = read_cmake if present[0] == "CMakeLists.txt" else read_setup
        return read(text, self._shares[folder], partial(self._find, folder))

    def _find(self, folder: str, pattern: str) -> list[str]:
        """Return the files below a folder that agree with a pattern of `glob`; `**` stands for any folders."""
        deep = re.sub(r"/?\*\*/", "/*/", f"/{pattern}")
        count = pattern.count("/")
        self.budget.charge(len(self.files_of(folder)) * (1 + len(pattern)))
        paths = ["/".join(parts) for parts in self.files_of(folder)]
        return [
            each
            for each in paths
            if (each.count("/") == count and fnmatchcase(each, pattern))
            or ("**" in pattern and (fnmatchcase(f"/{each}", deep) or fnmatchcase(each, pattern.replace("**/", ""))))
        ]

    def text_of(self, path: str) -> str:
        """Return the text of a file; an empty one if it cannot be read."""
        with suppress(OSError):
            return self.world.read_bytes(path).decode(errors="replace")
        return ""

    def files_of(self, folder: str) -> list[tuple[str, ...]]:
        """Return the files below a folder, at most MOST_FILES, as the parts of their paths."""
        if folder not in self._listed:
            self._listed[folder] = []
            waiting: list[tuple[str, ...]] = [()]
            while waiting and len(self._listed[folder]) < MOST_FILES:
                parts = waiting.pop()
                for name in self.list_folder("/".join((folder, *parts))):
                    if name.startswith("."):
                        continue
                    inner = (*parts, name)
                    if self.is_file("/".join((folder, *inner))):
                        self._listed[folder].append(inner)
                    else:
                        waiting.append(inner)
        return self._listed[folder]

    def module_paths(self, name: str, beside: str, folders_of_file: Iterable[object] = ()) -> list[str]:
        """Return the files that a Python module could be.

        It is beside a file, in the folders that the file adds to sys.path, or in the package of its name.
        """
        inner = name.lstrip(".")
        if level := len(name) - len(inner):  # of the package that the file is in, or of one above it
            whole = "/".join((*beside.split("/")[:-level], *filter(None, inner.split("."))))
            return [path for path in (f"{whole}.py" if inner else "", f"{whole}/__init__.py") if self.is_file(path)]
        first, *rest = name.split(".")
        folders = [beside.rpartition("/")[0], *(str(each) for each in folders_of_file)]
        with suppress(PackageNotFound, OSError, ValueError):
            share = self.world.find_package(first)
            folders.append(share)
            library = f"{share.removesuffix(f'/share/{first}')}/lib"
            for python in self.list_folder(library):
                folders += [f"{library}/{python}/{each}" for each in ("site-packages", "dist-packages")]
        paths = []
        for folder in folders:
            whole = "/".join((folder, first, *rest))
            paths += [f"{whole}.py", f"{whole}/__init__.py"]
        return [path for path in paths if self.is_file(path)]
