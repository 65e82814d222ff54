"""Packages that are not on this computer: the severity of a finding about one, and the list of all of them."""

from collections.abc import Iterable
from typing import NamedTuple

from ur.check.queries.executables import is_misspelt
from ur.check.rule import Package
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.suggest import did_you_mean

RULE_ID = "package-not-installed"


class NotInstalled(NamedTuple):
    """The sorted packages that launch files name but that are not installed, and the number of files that name any."""

    packages: tuple[str, ...]
    files: int


def judge_package(found: Diagnostic, package: Package | None, option: str | None, world: World) -> Diagnostic:
    """Turn a finding about an unknown package into `package-not-installed`, unless the name is misspelt.

    `package` is that of the checked file; `option` is the argument that is changed in the present case.
    """
    if found.rule != "unknown-package":
        return found
    name = found.subject
    declared = package is not None and name in package.depends
    near = did_you_mean(name, world.package_names())
    if not declared and near is not None and is_misspelt(name, near):
        return found
    why = ", though package.xml depends on it" if declared else f", and '{option}' needs it" if option else ""
    return found._replace(
        rule=RULE_ID,
        severity=Severity.WARNING,
        message=f"package '{name}' is not installed here{why}",
        help=f"install {name}, or source its workspace's setup.bash; what it holds is not checked until then",
    )


def split_not_installed(findings: Iterable[Diagnostic]) -> tuple[tuple[Diagnostic, ...], NotInstalled]:
    """Separate the findings about packages that are not installed from the others."""
    others: list[Diagnostic] = []
    packages: set[str] = set()
    files: set[str] = set()
    for found in findings:
        if found.rule != RULE_ID:
            others.append(found)
            continue
        packages.add(found.subject)
        if found.span is not None:
            files.add(found.span.file.path)
    return tuple(others), NotInstalled(tuple(sorted(packages)), len(files))
