"""Lazy loading of messages: their packages import all of them, and a node needs few.

The packages are made by rosidl: each line of their `__init__.py` imports one class from a module of its own. A package
with any other line is loaded as it is.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, cast

from ur_nodes.codecs.bare import BareGridUpdate, BareTransforms

if TYPE_CHECKING:
    import genpy

_BARE: Mapping[tuple[str, str], type[BareGridUpdate | BareTransforms]] = {
    each.BARE[:2]: each for each in (BareGridUpdate, BareTransforms)
}
_DEEPEST = 20  # types within types
_SEPARATOR = "\n" + "=" * 80 + "\n"


def find_class(type_name: str, part: str = "msg") -> type[genpy.Message] | None:
    """Find the class of a type, 'package/Name' or 'package/msg/Name'; None if it is not installed.

    `part` is 'srv' for a service.
    """
    package, name = split_type(type_name)
    if not package or _definition_file(package, name, part) is None:
        return None  # nothing is imported that a name from the network invents
    try:
        return cast("type[genpy.Message] | None", getattr(import_module(f"{package}.{part}"), name, None))
    except Exception:  # a package of a workspace raises anything
        return None


def find_schema(type_name: str) -> str | None:
    """Return the definition of a type and of its fields' types; None if it is not installed."""
    package, name = split_type(type_name)
    text = _read_definition(package, name)
    if text is None:
        return None
    parts, known, waiting = [text], set[str](), list(_types_in(text, package))
    while waiting and len(known) < _DEEPEST:
        each = waiting.pop(0)
        inner = _read_definition(*split_type(each))
        if each in known or inner is None:
            continue
        known.add(each)
        parts.append(f"MSG: {each}\n{inner}")
        waiting += _types_in(inner, split_type(each)[0])
    return _SEPARATOR.join(parts)


def find_bare(type_name: str) -> type[genpy.Message] | None:
    """Find the class of a type whose messages this project writes and reads as bytes; None for any other."""
    return cast("type[genpy.Message] | None", _BARE.get(split_type(type_name)))


def split_type(type_name: str) -> tuple[str, str]:
    """Split the name of a type into package and name; both are empty if it is no name of a type."""
    parts = type_name.split("/")
    if len(parts) not in (2, 3) or not all(each.isidentifier() for each in parts):
        return "", ""
    return parts[0], parts[-1]


def _read_definition(package: str, name: str) -> str | None:
    file = _definition_file(package, name)
    if file is not None:
        return file.read_text(encoding="utf-8")
    bare = _BARE.get((package, name))
    return None if bare is None else bare.DEFINITION


def _definition_file(package: str, name: str, part: str = "msg") -> Path | None:
    if not package:
        return None
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        file = Path(prefix, "share", package, part, f"{name}.{part}")
        if prefix and file.is_file():
            return file
    return None


def _types_in(text: str, package: str) -> Iterable[str]:
    """Return the types of the fields of a definition that are messages themselves."""
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if not words or not words[0][:1].isalpha():
            continue
        kind = words[0].partition("[")[0].partition("<")[0]
        if "/" in kind:
            yield kind
        elif kind[0].isupper():
            yield f"{package}/{kind}"


_KINDS = (".msg", ".srv", ".action")
_IMPORT = re.compile(r"from ([\w.]+) import (\w+)(?:\s*#.*)?")
_GENERATOR = "rosidl_generator_py.generate_py_impl"


class MessagePackage(Loader):
    """Makes a package whose classes, `modules` by name, are imported on first use."""

    def __init__(self, modules: Mapping[str, str]) -> None:
        self._modules = modules

    def create_module(self, spec: ModuleSpec) -> None:
        """See Loader: as usual."""

    def exec_module(self, module: ModuleType) -> None:
        """See Loader."""

        def find(name: str) -> object:
            if name not in self._modules:
                raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
            value = getattr(import_module(self._modules[name]), name)
            setattr(module, name, value)
            return value

        module.__dict__.update(__getattr__=find, __all__=sorted(self._modules), __dir__=lambda: sorted(self._modules))


class MessageFinder(MetaPathFinder):
    """Finds packages of messages."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """See MetaPathFinder."""
        if path is None or fullname.count(".") != 1 or not fullname.endswith(_KINDS):
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is None or not isinstance(spec.loader, SourceFileLoader):
            return None
        modules = read_imports(spec.loader.get_data(spec.loader.path).decode(errors="replace"))
        if modules is None:
            return None
        spec.loader = MessagePackage(modules)
        return spec


def read_imports(text: str) -> dict[str, str] | None:
    """Return the module of each class that a package of messages imports; None if it has other statements."""
    found = {}
    for line in text.splitlines():
        if not line.strip():
            continue
        match = _IMPORT.fullmatch(line)
        if match is None:
            return None
        module, name = match.groups()
        found[name] = module
    return found


def load_when_used() -> None:
    """Load messages lazily from now on, without the generator of their classes and its parser."""
    if not any(isinstance(each, MessageFinder) for each in sys.meta_path):
        sys.meta_path.insert(0, MessageFinder())
        sys.modules.setdefault(_GENERATOR, None)  # type: ignore[arg-type]  # an ImportError, as its package expects
