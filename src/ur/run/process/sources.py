"""Programs of packages that are not built: entry points of a colcon workspace's source packages."""

import os
import re
from collections.abc import Iterator

from ur.launchfile.plan.specs import NodeSpec
from ur.launchfile.world import PackageNotFound, World
from ur.launchfile.world.packages import read_package_name
from ur.system.ros import WHEELS

_MANIFEST = "package.xml"
_DECLARATIONS = ("setup.py", "setup.cfg", "pyproject.toml")
_RUN = "import sys; sys.path.insert(0, {folder!r}); from {module} import {function} as main; sys.exit(main())"


def find_source_program(node: NodeSpec, world: World) -> tuple[str, ...]:
    """Return the command of a node whose package is there as sources; () if it declares no such program.

    Such a package is one that is found, or one beside the launch file: in its own package, or in the same folder.
    """
    for folder in _folders(node, world):
        for name in _DECLARATIONS:
            path = f"{folder}/{name}"
            if world.is_file(path) and (found := _find_entry(world.read_bytes(path).decode("utf-8", "replace"), node)):
                module, function = found
                code = _RUN.format(folder=folder, module=module, function=function)
                return (_find_python(world), "-c", code)
        scripts = [f"{folder}/{inner}{node.type}" for inner in ("scripts/", f"{node.package}/", "bin/", "nodes/", "")]
        for script in filter(world.is_file, scripts):
            if script.endswith(".py"):
                return (_find_python(world), script)  # install(PROGRAMS ...) makes it executable
            if os.access(script, os.X_OK):
                return (script,)
    return ()


def _folders(node: NodeSpec, world: World) -> Iterator[str]:
    try:
        yield world.find_package(node.package)
        return
    except (PackageNotFound, OSError, ValueError):
        place = world.absolute(node.origin.span.file.path)
    while place.strip("/"):
        place = place.rpartition("/")[0]
        for folder in (place, f"{place}/{node.package}"):
            manifest = f"{folder}/{_MANIFEST}"
            if world.is_file(manifest) and _name_in(manifest) == node.package:
                yield folder
                return


def _name_in(manifest: str) -> str | None:
    try:
        return read_package_name(manifest)
    except (OSError, ValueError):
        return None


def _find_entry(text: str, node: NodeSpec) -> tuple[str, str] | None:
    """Return the module and the function of an entry point, as `NAME = MODULE:FUNCTION` declares it."""
    name = re.escape(node.type)
    found = re.search(rf"(?:^|[\s'\"\[,]){name}['\"]?\s*=\s*['\"]?([A-Za-z_][\w.]*)\s*:\s*([A-Za-z_]\w*)", text)
    return None if found is None else (found[1], found[2])


def _find_python(world: World) -> str:
    last = world.environment.get("AMENT_PREFIX_PATH", "").rpartition(os.pathsep)[2]
    return f"{last}/bin/python" if os.path.basename(last) == WHEELS else "python3"  # noqa: PTH119
