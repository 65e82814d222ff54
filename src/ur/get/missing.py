"""Packages that launch files and package.xml need and that are not installed."""

import re
from collections.abc import Iterable, Mapping

from ur.get.steps import PACKAGE_NAME, Missing
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.protocol import PackageNotFound, World

_NAMED = re.compile(
    r"""\$\(\s*find(?:-pkg-share|-pkg-prefix)?\s+([^\s()$]+)\s*\)|\bfind\(\s*['"]([^'"()$]+)['"]\s*\)|<(?:node|test)\b[^<>]{0,2000}?\bpkg\s*=\s*["']([^"'$]+)["']"""
)


def missing_of_plan(plan: Plan, world: World) -> tuple[Missing, ...]:
    """Return the missing packages and programs of a plan's nodes on this computer, and of its files.

    The includes of a file in a missing package are unknown until that package is installed.
    """
    found: dict[str, Missing] = {}
    for each in plan.diagnostics:
        if (
            each.rule == "unknown-package"
            and PACKAGE_NAME.fullmatch(each.subject)
            and not is_installed(each.subject, world)
        ):
            found.setdefault(each.subject, Missing(each.subject))
    for node in plan.all_nodes():
        if not plan.is_local(node):
            continue
        try:
            if not world.find_files(node.package, node.type):
                found.setdefault(node.package, Missing(node.package, node.type))
        except (PackageNotFound, OSError, ValueError):
            found[node.package] = Missing(node.package)
    return tuple(found.values())


def named_packages(text: str) -> frozenset[str]:
    """Return every package that the text of a launch file or xacro file names, under any condition."""
    names = (next(filter(None, each.groups()), "") for each in _NAMED.finditer(_without_comments(text)))
    return frozenset(name for name in names if PACKAGE_NAME.fullmatch(name))


def _without_comments(text: str) -> str:
    # Not by a regular expression: where many comments begin and none ends, its time is the square of the length.
    parts = []
    at = 0
    while (start := text.find("<!--", at)) >= 0 and (end := text.find("-->", start + 4)) >= 0:
        parts.append(text[at:start])
        at = end + 3
    return "".join([*parts, text[at:]])


def missing_of_names(names: Iterable[str] | Mapping[str, str], world: World) -> tuple[Missing, ...]:
    """Return the packages, of these, that are not installed, sorted; a mapping has the files that name them."""
    files = names if isinstance(names, Mapping) else {}
    return tuple(
        Missing(name, named_in=files.get(name, "")) for name in sorted(set(names)) if not is_installed(name, world)
    )


def is_installed(package: str, world: World) -> bool:
    """Return whether a ROS package is found."""
    try:
        world.find_package(package)
    except (PackageNotFound, OSError, ValueError):
        return False
    return True
