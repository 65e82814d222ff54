"""Driver packages of a real base: missing ones, and their installation, before anything starts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ur.launchfile.plan.specs import NodeSpec
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.request.bases.base_argument import FileBase
from ur.robot.base import Base, UpstreamDriver
from ur.source.diagnostic import Diagnostic, UserError, error


def check_drivers(bases: Iterable[FileBase], nodes: Sequence[NodeSpec], world: World) -> None:
    """Compare the packages of nodes with the drivers in the base file.

    Raises UserError with one finding for each driver package that is not installed on this computer.
    """
    unique = {each.package: each.base for each in bases}
    missing = [found for package in sorted(unique) for found in _missing(unique[package], nodes, world)]
    if missing:
        raise UserError(*missing)


def _missing(base: Base, nodes: Sequence[NodeSpec], world: World) -> Iterator[Diagnostic]:
    for driver in (base.driver, *base.drivers):
        used = [node for node in nodes if driver and node.package == driver.package]
        if driver and used and not _is_installed(driver, world):
            whole = f"{base.name}, variant {base.variant}" if base.variant else base.name
            what = f"drives a real {whole}" if driver.part == "base" else f"reads the {driver.part} of a real {whole}"
            yield error(
                f"package {driver.package!r} is not installed: its {driver.executable} {what}",
                used[0].origin.span,
                rule="no-driver",
                help=f"{driver.install}; or simulate the base: simulate:=true",
            )


def _is_installed(driver: UpstreamDriver, world: World) -> bool:
    try:
        world.find_package(driver.package)
    except PackageNotFound:
        return False
    return True
