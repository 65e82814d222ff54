"""Modules that launch files import, as far as they compute: os, pathlib, yaml, xacro, and the launch API.

Files are read through the World, with its limits; nothing is written, started or sent.
"""

import posixpath
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import PurePosixPath
from typing import Any

from ur.launchfile.plan.values import expression_functions as functions
from ur.launchfile.ros2.api import modules
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.nav2 import read_poses
from ur.launchfile.ros2.python.api_class import ApiClass
from ur.launchfile.ros2.python.objects import (
    ContextObject,
    Instance,
    Module,
    Opened,
    UserClass,
    make_path,
    taking_unknown,
)
from ur.launchfile.ros2.python.standard import Standard
from ur.launchfile.ros2.substitutions import perform
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.file import Span
from ur.source.suggest import did_you_mean

_TRANSITIONS = (
    *("CREATE", "CONFIGURE", "CLEANUP", "ACTIVATE", "DEACTIVATE", "UNCONFIGURED_SHUTDOWN", "INACTIVE_SHUTDOWN"),
    *("ACTIVE_SHUTDOWN", "DESTROY"),
)
_SOURCED = frozenset({"AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH", "ROS_DISTRO"})
_MATCHING = {
    **dict.fromkeys(
        ("launch.events", "launch.actions", "launch.event_handlers", "launch_ros.events"),
        ("matches_action", "matches_node_name", "matches_pid"),
    ),
    "launch_ros.events.lifecycle": ("matches_node_name",),
}
_IGNORED = frozenset(
    {
        *("__future__", "abc", "argparse", "collections", "enum", "getpass", "importlib", "inspect", "itertools"),
        *("logging", "multiprocessing", "random", "shutil", "uuid", "warnings"),
    }
)


class PackageNotFoundError(KeyError):
    """The exception of ament_index_python, as files handle it by its name."""


_TYPES: dict[str, object] = {"List": list, **dict.fromkeys(("Dict", "Mapping", "MutableMapping"), dict)}


class Library:
    """The modules of one launch file in its context."""

    def __init__(self, context: Context, path: str) -> None:
        self._context, self._world, self._path = context, context.world, path
        self.standard = Standard(context)
        self._own: dict[str, Callable[[], Module]] = {
            **self.standard.modules,
            "os": self._os,
            "os.path": self._os_path,
            "math": lambda: Module("math", functions.MATH),
            "typing": lambda: Module("typing", _TYPES | {"TYPE_CHECKING": False}),
            "pathlib": lambda: Module("pathlib", {"Path": make_path, "PurePath": make_path}),
            "xacro": lambda: Module(
                "xacro", {"process_file": taking_unknown(self._expand), "process": taking_unknown(self._expand_text)}
            ),
            "ament_index_python": self._index,
            "ament_index_python.packages": self._index,
            "ament_index_python.resources": lambda: Module(
                "ament_index_python.resources", {"has_resource": self._has_resource}
            ),
            "lifecycle_msgs.msg": _lifecycle,
        }
        self._found: dict[str, Module | None] = {}
        self.is_tried: Callable[[], bool] = lambda: False
        """True where a `try` of the file is around the present place."""

    def find(self, name: str) -> Module | None:
        """Return a module; None if it is none of those here."""
        if name not in self._found:
            self._found[name] = self._make(name)
        return self._found[name]

    def _make(self, name: str) -> Module | None:
        if name in self._own:
            return self._own[name]()
        if (known := _api_module(name)) is not None:
            return known
        inner = {own[len(name) + 1 :]: self.find(own) for own in self._own if own.startswith(f"{name}.")}
        return Module(name, inner) if inner or name.partition(".")[0] in _IGNORED else None

    def make_context(self) -> ContextObject:
        """Return what LaunchContext() makes."""
        made = Context(self._world, self._context.budget, {})
        made.rewritten, made.written = self._context.rewritten, self._context.written  # one file system
        return ContextObject(made)

    def builtins(self) -> dict[str, object]:
        """Return the names that every file has."""
        return {
            "__file__": self._path,
            "__name__": "launch_file",
            "open": self._open,
            "print": taking_unknown(lambda *_, **__: None),
            "isinstance": _is_instance,
            "hasattr": lambda value, name: name in getattr(value, "values", ()),
            "super": lambda *_: Module("super()", {"__init__": taking_unknown(lambda *_, **__: None)}),
        }

    @property
    def _at(self) -> Span | None:
        return self.standard.find_place()

    def find_share(self, package: str) -> str | Unknown:
        """Return the share folder of a package; a package that is missing is reported once.

        Where the file itself handles this, PackageNotFoundError is raised.
        """
        if self.is_tried():
            try:
                self._world.find_package(package)
            except (PackageNotFound, OSError, ValueError):
                raise PackageNotFoundError(package) from None
        return self._context.find_share(package, self._at)

    def find_prefix(self, package: str) -> str | Unknown:
        """Return the folder into which a package is installed, likewise."""
        share = self.find_share(package)
        return share if isinstance(share, Unknown) else share.removesuffix(f"/share/{package}")

    def _find_share_path(self, package: str, *_: object, **__: object) -> PurePosixPath | Unknown:
        share = self.find_share(package)
        return share if isinstance(share, Unknown) else make_path(share)

    def find_method(self, value: object, name: str) -> object:
        """Return a method that needs the computer, of a value; None if it is none of those."""
        if isinstance(value, PurePosixPath):
            return self._method_of_path(str(value), name)
        if not isinstance(value, Made):
            return None
        if name == "find" and value.kind.startswith("FindPackage"):
            return self.find_share if value.kind.endswith("Share") else self.find_prefix
        if name == "value" and value.kind == "ParseMultiRobotPose":
            text = self._context.configurations.get(str(value.get("target_argument")), "")
            return lambda: read_poses(text, self._context) if isinstance(text, str) else text
        return None

    def _method_of_path(self, path: str, name: str) -> object:
        methods: dict[str, Callable[..., object]] = {
            "exists": lambda: self.standard.exists(path),
            "glob": lambda pattern: [make_path(each) for each in self.standard.find(f"{path}/{pattern}")],
            "is_dir": lambda: bool(self._context.list_folder(path)),
            "is_file": lambda: path in self._context.written or self._context.is_file(path),
            "iterdir": lambda: [make_path(path, each) for each in self._context.list_folder(path)],
            "mkdir": _do_nothing,
            "open": lambda mode="r", *_, **__: self._open(path, mode),
            "read_text": lambda *_, **__: self.standard.read(path),
            "unlink": _do_nothing,
            "write_text": lambda text, *_, **__: self.standard.write(path).write(text),
        }
        return methods.get(name)

    # -- modules

    def _index(self) -> Module:
        members: dict[str, object] = {
            "get_package_share_directory": lambda package_name, *_, **__: self.find_share(package_name),
            "get_package_share_path": lambda package_name, *_, **__: self._find_share_path(package_name),
            "get_package_prefix": lambda package_name: self.find_prefix(package_name),
            "get_packages_with_prefixes": self.standard.prefixes,
            "PackageNotFoundError": PackageNotFoundError,
        }
        return Module(
            "ament_index_python.packages", {**members, "packages": Module("ament_index_python.packages", members)}
        )

    def _has_resource(self, kind: object, name: object) -> object:
        if kind == "packages":
            with suppress(PackageNotFound):
                return self._world.find_package(str(name)).removesuffix(f"/share/{name}")
        return Unknown(f"{name} is not installed", self._at, "package")

    def _os(self) -> Module:
        environment = self._context.environment
        return Module(
            "os",
            {
                "path": self._os_path(),
                "environ": environment,
                "getenv": self._getenv,
                "system": self.standard.refuse("system"),
                **dict.fromkeys(("makedirs", "mkdir", "remove", "unlink", "chmod"), taking_unknown(_do_nothing)),
                "sep": "/",
                "pathsep": ":",
                "linesep": "\n",
                "name": "posix",
                "getcwd": lambda: self._world.absolute("."),
                "listdir": lambda path=".": list(self._context.list_folder(str(path))),
                "PathLike": PurePosixPath,
            },
        )

    def _getenv(self, name: str, default: object = None) -> object:
        value = self._context.environment.get(name, default)
        if value is None and name in _SOURCED:
            return Unknown(f"{name} is not set: no ROS 2 is sourced", self._at, "package")
        return value

    def _os_path(self) -> Module:
        world, context = self._world, self._context

        def absolute(path: object) -> str:
            return world.absolute(str(path))

        def expand(path: object) -> str:
            text, home = str(path), self._context.environment.get("HOME", "")
            return home + text[1:] if text == "~" or text.startswith("~/") else text

        def fill(path: object) -> str:
            known = self._context.environment
            return re.sub(r"\$(\w+)|\$\{(\w+)\}", lambda found: known.get(found[1] or found[2], found[0]), str(path))

        pure = {
            name: _on_texts(getattr(posixpath, name)) for name in ("join", "dirname", "basename", "normpath", "split")
        }
        pure |= {name: _on_texts(getattr(posixpath, name)) for name in ("splitext", "isabs", "relpath", "commonpath")}
        return Module(
            "os.path",
            {
                **pure,
                "sep": "/",
                "abspath": absolute,
                "realpath": absolute,
                "expanduser": expand,
                "expandvars": fill,
                "exists": self.standard.exists,
                "isfile": lambda path: str(path) in context.written or context.is_file(str(path)),
                "isdir": lambda path: bool(context.list_folder(str(path))),
            },
        )

    # -- functions

    def _open(self, path: object, mode: str = "r", *_: object, **__: object) -> object:
        if mode.strip("tb+") in ("w", "x"):
            return self.standard.write(path)
        if set(mode) - set("rtb"):
            return Unknown("the file changes a file", self._at)
        try:
            text = self.standard.read(path)
            return Opened(str(path), text.replace("\r\n", "\n"))
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            raise FileNotFoundError(f"{path}: {reason}") from None

    def _expand_text(self, *arguments: Any, **keywords: Any) -> object:
        text: Any = self._expand(*arguments, **keywords).members["toxml"]
        return text()

    def _expand(self, path: object, *_: object, mappings: object = None, **__: object) -> Module:
        words: list[object] = ["xacro ", path]
        if isinstance(mappings, dict):
            for name, value in mappings.items():
                words += [" ", name, ":=", value]
        at = self._at
        made = Made("Command", {"command": words}, at) if at is not None else None
        text = taking_unknown(lambda *_, **__: made)
        return Module(
            "the expanded file", {"toxml": text, "toprettyxml": text, "documentElement": Unknown("xacro", at)}
        )


def _on_texts(function: Callable[..., object]) -> Callable[..., object]:
    def call(*paths: Any) -> object:
        for path in paths:
            if isinstance(path, Made):
                raise TypeError(f"a path is {path.kind}, expected a text: use PathJoinSubstitution")
        return function(*(path if isinstance(path, list) else str(path) for path in paths))

    return call


def _is_instance(value: object, kind: object) -> object:
    kinds = kind if isinstance(kind, tuple) else (kind,)
    for each in kinds:
        if isinstance(each, type) and isinstance(value, each):
            return True
        if isinstance(each, UserClass) and isinstance(value, Instance) and value.of is each:
            return True
        if isinstance(each, ApiClass) and (
            (isinstance(value, Made) and each.signature.kind in (value.kind, "Action", "Substitution"))
            or (isinstance(value, Instance) and each.signature.kind == "Substitution")
        ):
            return True
    return False


def _lifecycle() -> Module:
    states = {f"TRANSITION_{name}": number for number, name in enumerate(_TRANSITIONS)}
    primary = {
        f"PRIMARY_STATE_{name}": number
        for number, name in enumerate(("UNKNOWN", "UNCONFIGURED", "INACTIVE", "ACTIVE", "FINALIZED"))
    }
    return Module("lifecycle_msgs.msg", {"Transition": Module("Transition", states), "State": Module("State", primary)})


def _as_list(value: object) -> list[object]:
    return list(value) if isinstance(value, (list, tuple)) else [value]


def _perform(context: object, value: object) -> object:
    return (
        perform(value, context.context) if isinstance(context, ContextObject) else Unknown("the context is not known")
    )


_HELPERS: Mapping[str, Mapping[str, object]] = {
    "launch.utilities": {
        "normalize_to_list_of_substitutions": taking_unknown(_as_list),
        "perform_substitutions": taking_unknown(_perform),
    }
}


@cache
def _api_module(name: str) -> Module | None:
    """Return a module of the launch API, the same for all files; None if it is none."""
    members: dict[str, object] = {known: ApiClass(signature) for known, signature in modules().get(name, {}).items()}
    members |= _HELPERS.get(name, {})
    for last in _inner_modules().get(name, ()):
        members.setdefault(last, _api_module(f"{name}.{last}"))
    if not members:
        return None
    return Module(name, members | dict.fromkeys(_MATCHING.get(name, ()), taking_unknown(_matcher)))


@cache
def _inner_modules() -> Mapping[str, tuple[str, ...]]:
    """Return the modules of the API in each module, by the last parts of their names."""
    found: dict[str, dict[str, None]] = {}
    for known in (*modules(), *_HELPERS):
        while "." in known:
            parent, _, last = known.rpartition(".")
            found.setdefault(parent, {})[last] = None
            known = parent
    return {name: tuple(inner) for name, inner in found.items()}


def _do_nothing(*_: object, **__: object) -> None:
    return None


def _matcher(*values: object, **keywords: object) -> object:
    return ("matches", *values, *keywords.values())


def missing_member(module: Module, name: str, span: Span) -> DescriptionProblem:
    """Return the problem that a module of the launch API has no such name."""
    near = did_you_mean(name, module.members)
    places = [known for known, classes in modules().items() if name in classes]
    if places:
        help_ = f"import it from {places[0]}"
    elif near:
        help_ = f"did you mean {near}?"
    else:
        help_ = "see the documentation of this module"
    return DescriptionProblem(
        f"{module.name} has no {name}, expected a name that it has", "launch-import", span, help_, name
    )


def is_api(name: str) -> bool:
    """Return whether a module belongs to the launch API, all of whose names are known."""
    return name in modules() and not name.startswith("nav2_common")


def is_below_api(name: str) -> bool:
    """Return whether a module is one of a package of the launch API, known or not."""
    top = name.partition(".")[0]
    return top != "nav2_common" and any(each.partition(".")[0] == top for each in modules())
