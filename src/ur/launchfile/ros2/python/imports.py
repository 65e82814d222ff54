"""Import statements of Python launch files: modules that are known, and files beside the launch file."""

import ast
import sys
from typing import cast

from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import DescriptionProblem, Unknown
from ur.launchfile.ros2.python.expressions import Expressions
from ur.launchfile.ros2.python.modules import Library, is_api, is_below_api, missing_member
from ur.launchfile.ros2.python.objects import Module


class Imports:
    """Runs the import statements of a file."""

    _expressions: Expressions
    _library: Library
    _context: Context

    def _report(self, problem: DescriptionProblem) -> None:
        raise NotImplementedError

    def _read_module(self, name: str, path: str) -> Module | None:
        raise NotImplementedError

    def _run_Import(self, node: ast.Import) -> None:  # noqa: N802
        for alias in node.names:
            names = self._expressions.frame.names_here
            whole = self._find_module(alias.name) or self._missing_module(alias.name, node)
            if alias.asname or "." not in alias.name:
                names[alias.asname or alias.name] = whole
                continue
            top, *inner = alias.name.split(".")
            module: object = self._find_module(top) or names.get(top)
            if not inner or not isinstance(module, Module) or inner[0] not in module.members:
                for part in reversed(inner[1:]):
                    whole = Module(part, {part: whole})
                known = module.members if isinstance(module, Module) else {}
                module = Module(top, {**known, inner[0]: whole})
            names[top] = module

    def _run_ImportFrom(self, node: ast.ImportFrom) -> None:  # noqa: N802
        name = "." * node.level + (node.module or "")
        module = self._find_module(name)
        names = self._expressions.frame.names_here
        for alias in node.names:
            target = alias.asname or alias.name
            inner = f"{name}.{alias.name}" if node.module else f"{name}{alias.name}"
            if alias.name == "*" and module is not None:
                names.update(module.members)
            elif module is not None and alias.name in module.members:
                names[target] = module.members[alias.name]
            elif module is not None and is_api(name):
                self._report(missing_member(module, alias.name, self._expressions.span(alias)))
                names[target] = Unknown(f"{name} has no {alias.name}", self._expressions.span(alias))
            elif (found := self._find_module(inner)) is not None:  # also of a package that is being read
                names[target] = found
            elif module is None:
                names[target] = self._missing_module(name, node)
            else:
                names[target] = Unknown(f"{inner} is not computed while reading", self._expressions.span(node))

    def _find_module(self, name: str) -> Module | None:
        """Return a module: one that is known, or a file of a package or beside the launch file, which is read."""
        known = self._library.find(name)
        if known is not None or is_below_api(name):  # of which a workspace may have the sources
            return known
        context = self._context
        for path in context.module_paths(name, self._expressions.source.path, self._library.standard.paths):
            if path not in context.modules:
                context.modules[path] = None  # while it is read: modules may import one another
                context.modules[path] = self._read_module(name, path)
            return cast("Module | None", context.modules[path])
        return None

    def _missing_module(self, name: str, node: ast.stmt) -> Unknown:
        here, top = self._expressions, name.partition(".")[0]
        if top in sys.stdlib_module_names or not top or is_below_api(name):
            return Unknown(f"the module {name} is not followed while reading", here.span(node))
        return Unknown(f"the Python module {name} is not installed", here.span(node), "package")
