"""Lazy loading: packages of messages import all of them, of which a node needs few; rospy imports catkin for nothing.

The packages are made by rosidl or genpy: each line of their `__init__.py` imports one class from a module of its own. A
package with any other line is loaded as it is, and services of ROS 1 are, whose modules have three classes.
"""

import re
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import ModuleType

_KINDS = (".msg", ".srv", ".action")
_IMPORT = re.compile(r"from (?:([\w.]+) import (\w+)|\._(\w+) import \*)(?:\s*#.*)?")
_GENERATOR = "rosidl_generator_py.generate_py_impl"
_CATKIN = "catkin.find_in_workspaces"


class MessagePackage:
    """Makes a package whose classes, `modules` by name, are imported on first use."""

    def __init__(self, modules: Mapping[str, str]) -> None:
        self._modules = modules

    create_module = staticmethod(lambda _spec: None)  # as usual

    def exec_module(self, module: ModuleType) -> None:
        """See Loader."""

        def find(name: str) -> object:
            if name not in self._modules:
                raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
            value = getattr(import_module(self._modules[name]), name)
            setattr(module, name, value)
            return value

        module.__dict__.update(__getattr__=find, __all__=sorted(self._modules), __dir__=lambda: sorted(self._modules))


class MessageFinder:
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
        modules = read_imports(spec.loader.get_data(spec.loader.path).decode(errors="replace"), fullname)
        if modules is None:
            return None
        spec.loader = MessagePackage(modules)  # type: ignore[assignment]  # its class imports 1.5 MB
        return spec


def read_imports(text: str, package: str) -> dict[str, str] | None:
    """Return the module of each class that a package of messages imports; None if it has other statements."""
    found = {}
    for line in text.splitlines():
        if not line.strip():
            continue
        match = _IMPORT.fullmatch(line)
        if match is None or (match[3] and package.endswith(".srv")):
            return None
        module, name, own = match.groups()
        found[name or own] = module or f"{package}._{own}"
    return found


def load_when_used() -> None:
    """Load messages lazily from now on, without the generator of their classes and its parser."""
    if not any(isinstance(each, MessageFinder) for each in sys.meta_path):
        sys.meta_path.insert(0, MessageFinder())
        sys.modules.setdefault(_GENERATOR, None)  # type: ignore[arg-type]  # an ImportError, as its package expects


def defer_catkin() -> None:
    """Import what finds packages in workspaces when it is used: 4 MB, which rospy imports and never calls."""
    module = ModuleType(_CATKIN)

    def find_in_workspaces(*arguments: object, **options: object) -> object:
        del sys.modules[_CATKIN]
        from catkin.find_in_workspaces import find_in_workspaces  # type: ignore[import-untyped]

        return find_in_workspaces(*arguments, **options)

    module.find_in_workspaces = find_in_workspaces  # type: ignore[attr-defined]
    sys.modules.setdefault(_CATKIN, module)
