"""Modules of Python's library and of ROS 2's tools that launch files use, as far as they compute without an effect.

A file that is written is kept in memory, where the same launch reads it again; nothing is written, removed or run.
"""

import copy
import json
import posixpath
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from fnmatch import fnmatchcase
from functools import partial
from typing import Any

from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import DescriptionProblem, Unknown
from ur.launchfile.ros2.python.expressions import NotRead
from ur.launchfile.ros2.python.objects import FieldDefault, Module, UserClass, Written, taking_unknown
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.file import Span
from ur.source.foreign.xml_text import parse_xml

_MOST_FOUND = 2_000  # files of a pattern
_EXPORT = re.compile(rb"<export>(?:(?!</export>).)*?<(?!build_type|/|!|architecture|deprecated)", re.DOTALL)
_PER_FOLDER = 1_000  # units of work
_PER_DUMP = 100  # times as much as to weigh a value
_LONGEST_PATTERN = 100
_PER_SEARCH = 100  # steps of a pattern a unit of work
_PROGRAMS = ("run", "call", "check_call", "check_output", "Popen", "getoutput")
_DECORATORS = ("cache", "lru_cache", "total_ordering", "wraps")


class InvalidPackage(ValueError):  # noqa: N818 - as files handle it by its name
    """The exception of catkin_pkg for a package.xml that cannot be read."""


class Standard:
    """The modules of one launch in its context."""

    def __init__(self, context: Context) -> None:
        self._context, self._world = context, context.world
        self.text = ""  # of the file that is read
        self.find_place: Callable[[], Span | None] = lambda: None  # of the statement that is read
        self.paths: list[object] = []  # sys.path
        self.modules: Mapping[str, Callable[[], Module]] = {
            "copy": lambda: self._module("copy", copy=self._copy, deepcopy=self._copy),
            "dataclasses": lambda: self._module("dataclasses", field=taking_unknown(_field)),
            "functools": lambda: Module("functools", dict.fromkeys(_DECORATORS, taking_unknown(lambda *_, **__: None))),
            "glob": lambda: self._module("glob", glob=lambda path, **_: list(self.find(str(path)))),
            "json": lambda: self._module("json", loads=self.load, load=self.load, dumps=self._dump_json),
            "datetime": lambda: self._module("datetime", datetime=self._at_start("datetime", "now", "today")),
            "re": self._re,
            "platform": lambda: Module(
                "platform",
                {**self._at_start("platform", "node", "uname", "release", "machine").members, "system": _linux},
            ),
            "socket": lambda: self._at_start("socket", "gethostname"),
            "time": lambda: self._at_start("time", "time", "strftime"),
            "ros2pkg.api": lambda: self._module("ros2pkg.api", get_package_names=self._package_names),
            "catkin_pkg.package": self._catkin,
            "subprocess": lambda: Module("subprocess", {name: self.refuse(name) for name in _PROGRAMS}),
            "sys": self._sys,
            "tempfile": self._tempfile,
            "yaml": self._yaml,
        }

    def _module(self, name: str, **members: object) -> Module:
        return Module(name, members)

    def _copy(self, value: object, *_: object) -> object:
        self._context.budget.weigh(value)
        return copy.copy(value) if not isinstance(value, (dict, list)) else _copy_containers(value)

    def _dump_json(self, value: object, **_: object) -> str:
        self._context.budget.weigh(value)
        return json.dumps(value)

    def _sys(self) -> Module:
        members = {"path": self.paths, "argv": ["ros2", "launch"], "executable": "/usr/bin/python3"}
        return Module("sys", {**members, "platform": "linux", "exit": taking_unknown(self._exit)})

    def _re(self) -> Module:
        names = ("search", "match", "fullmatch")

        def search(name: str, pattern: object, text: object) -> object:
            if not isinstance(pattern, str) or not isinstance(text, str) or not _is_simple(pattern):
                return Unknown("this pattern is not computed while reading", self.find_place())
            self._context.budget.spend(len(pattern) * (1 + len(text)) ** (1 + _count_repeats(pattern)) // _PER_SEARCH)
            found = getattr(re, name)(pattern, text)
            return found and Module("match", {"group": found.group, "groups": found.groups, "start": found.start})

        def compile_(pattern: object) -> Module:
            return self._module("pattern", **{name: partial(search, name, pattern) for name in names})

        return self._module("re", compile=compile_, **{name: partial(search, name) for name in names})

    # -- packages

    def _at_start(self, module: str, *names: str) -> Module:
        def make(name: str) -> Callable[..., object]:
            reason = f"{module}.{name}() is known when the launch starts"
            return taking_unknown(lambda *_, **__: Unknown(reason, self.find_place(), "command"))

        return Module(module, {name: make(name) for name in names})

    def refuse(self, name: str) -> Callable[..., object]:
        """Return a function that would run a program: it is named, and its result is not known."""

        def call(*_: object, **__: object) -> Unknown:
            refused = Unknown(f"a program is not run while reading: {name}()", self.find_place())
            self._context.add_gap(refused)
            return refused

        return taking_unknown(call)

    def _exit(self, *reason: object) -> object:
        at = self.find_place()
        if reason and isinstance(reason[0], Unknown) and at is not None:
            raise NotRead(f"the file ends here: {reason[0].reason}", at)
        text = f"the file ends the launch: {reason[0]}" if reason and isinstance(reason[0], str) else "the file ends"
        raise DescriptionProblem(f"{text}, expected a description", "launch-function", None)

    def _package_names(self) -> list[str]:
        names = sorted(self._world.package_names())
        self._context.budget.charge(_PER_FOLDER + 20 * len(names))
        if "parse_package" not in self.text:
            return names
        return [name for name in names if self._exports(name)]  # the others are skipped: there are hundreds

    def _exports(self, name: str) -> bool:
        with suppress(PackageNotFound, OSError, ValueError):
            data = self._world.read_bytes(f"{self._world.find_package(name)}/package.xml")
            return bool(_EXPORT.search(data))
        return False

    def prefixes(self) -> dict[str, str]:
        """Return the folders into which packages are installed, by the names of the packages."""
        found = {}
        for name in self._package_names():
            with suppress(PackageNotFound, OSError, ValueError):
                found[name] = self._world.find_package(name).removesuffix(f"/share/{name}")
        return found

    def _catkin(self) -> Module:
        members = {"InvalidPackage": InvalidPackage, "PACKAGE_MANIFEST_FILENAME": "package.xml"}
        return Module("catkin_pkg.package", {**members, "parse_package": self._parse_package})

    def _parse_package(self, path: object, *_: object) -> Module:
        data = self._context.read(str(path))
        try:
            exports = [] if b"<export" not in data else parse_xml(data).findall("export/*")
        except ValueError as problem:
            raise InvalidPackage(str(problem)) from None
        made = [
            Module("export", {"tagname": each.tag, "attributes": dict(each.attrib), "content": each.text or ""})
            for each in exports
        ]
        return Module("package", {"exports": made})

    # -- files

    def find(self, pattern: str) -> Iterator[str]:
        """Return the paths that agree with a pattern of `glob`, without those below `**`."""
        folders = ["/"] if pattern.startswith("/") else [self._world.absolute(".")]
        for part in pattern.strip("/").split("/"):
            found: list[str] = []
            for folder in folders:
                if not set("*?[") & set(part):
                    found.append(posixpath.join(folder, part))
                    continue
                names = [name for name in self._context.list_folder(folder) if fnmatchcase(name, part)]
                self._context.budget.charge(len(names) * len(part) + _PER_FOLDER)
                found += [posixpath.join(folder, name) for name in names if part[0] == "." or name[0] != "."]
            folders = found[:_MOST_FOUND]
        return (path for path in folders if self.exists(path))

    def exists(self, path: object) -> bool:
        """Return whether there is a file or folder, or a file that this launch has written."""
        text = str(path)
        if text in self._context.written or self._context.is_file(text) or self._context.list_folder(text):
            return True
        return self._context.find_file(text) != text

    def read(self, path: object) -> str:
        """Return the text of a file. Raises OSError."""
        known = self._context.written.get(str(path))
        if known is not None:
            return str(known)
        return self._context.read(self._context.find_file(str(path))).decode(errors="replace")

    def write(self, path: object) -> Written:
        """Return a file whose text is kept."""
        return Written(str(path), self._keep)

    def _keep(self, path: str, text: str) -> None:
        self._context.budget.charge(10 + len(text) // 20)
        self._context.written[path] = text

    def _tempfile(self) -> Module:
        def name(suffix: str | None = "", prefix: str | None = "tmp", dir: str | None = None, **_: object) -> str:
            self._context.temporary += 1
            return f"{dir or '/tmp'}/{prefix or 'tmp'}{self._context.temporary}{suffix or ''}"  # noqa: S108 - a text

        def file(_: str = "w+b", *, suffix: str | None = "", prefix: str | None = "tmp", **__: object) -> Written:
            return self.write(name(suffix, prefix))

        members: dict[str, object] = dict.fromkeys(("mktemp", "mkdtemp"), name)
        members |= {"gettempdir": lambda: "/tmp", "NamedTemporaryFile": file}  # noqa: S108 - likewise
        return Module("tempfile", {**members, "mkstemp": lambda *given, **named: (0, name(*given, **named))})

    # -- data

    def load(self, value: object, *_: object, **__: object) -> object:
        """Return the value of a text in YAML or JSON, or of a file that is open."""
        text = value.text if hasattr(value, "text") else value
        if not isinstance(text, str):
            return Unknown("what it reads is not a text")
        return self._context.load_yaml(text)

    def _yaml(self) -> Module:
        loads: dict[str, object] = dict.fromkeys(("safe_load", "load", "full_load", "unsafe_load"), self.load)
        loads |= dict.fromkeys(("SafeLoader", "FullLoader", "Loader", "CSafeLoader", "Dumper", "SafeDumper"))
        return Module("yaml", {**loads, **dict.fromkeys(("dump", "safe_dump"), self._dump), "YAMLError": ValueError})

    def _dump(self, value: object, stream: object = None, *_: object, **__: object) -> object:
        self._context.budget.weigh([value] * _PER_DUMP)
        import yaml  # few files

        text = yaml.safe_dump(value)
        return stream.write(text) if isinstance(stream, Written) else text


def _count_repeats(pattern: str) -> int:
    return sum(map(pattern.count, "*+{"))


def _is_simple(pattern: str) -> bool:
    """Return whether a pattern takes polynomial time: at most two repeats, none of a group."""
    is_short = len(pattern) <= _LONGEST_PATTERN and _count_repeats(pattern) <= 2
    return is_short and not re.search(r"\)[*+?{]|\(\?", pattern)


def _field(*, default_factory: Any = None, **options: object) -> object:
    if "default" in options:
        return options["default"]
    if isinstance(default_factory, UserClass):
        return FieldDefault(lambda: default_factory.make([], {}))
    return FieldDefault(default_factory)  # None: it has no default, and is given or assigned


def _linux() -> str:
    return "Linux"


def _copy_containers(value: object) -> object:
    if isinstance(value, dict):
        return {key: _copy_containers(each) for key, each in value.items()}
    return [_copy_containers(each) for each in value] if isinstance(value, list) else value
