"""Are the packages there that drive a real base? If not: which one, why, and how to get it, before anything starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ur.launchfile.plan.model import NodeSpec
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.request.base_argument import find_package
from ur.robot.base import Base, Driver, load_base
from ur.robot.base.search import find_base_package
from ur.source.diagnostic import Diagnostic, UserError, error


def check_drivers(files: Sequence[str], values: Mapping[str, str], nodes: Sequence[NodeSpec], world: World) -> None:
    """Compare the packages of nodes with the drivers that the file of the base names.

    `values` are the arguments that are given; without `robot_base` among them nothing is looked at. Raises UserError
    with one finding for each driver's package that is not on this computer.
    """
    name = values.get("robot_base")
    own = {found for path in files if (found := find_package(path))}
    if name is None or not nodes:
        return
    packages = {find_base_package(package, name, world.environment) for package in own}
    bases = [load_base(package, name, values.get("robot_variant", "")) for package in sorted(packages)]
    missing = [found for base in bases for found in _missing(base, nodes, world)]
    if missing:
        raise UserError(*missing)


def _missing(base: Base, nodes: Sequence[NodeSpec], world: World) -> Iterator[Diagnostic]:
    for driver in (base.driver, *base.drivers):
        used = [node for node in nodes if driver and node.package == driver.package]
        if driver and used and not _is_installed(driver, world):
            whole = f"{base.name}, variant {base.variant}" if base.variant else base.name
            what = f"drives a real {whole}" if driver.part == "base" else f"reads the {driver.part} of a real {whole}"
            yield error(
                f"package {driver.package!r} is not on this computer: its {driver.executable} {what}",
                used[0].origin.span,
                rule="no-driver",
                help=f"{driver.install}; or simulate the base: simulate:=true",
            )


def _is_installed(driver: Driver, world: World) -> bool:
    try:
        world.find_package(driver.package)
    except PackageNotFound:
        return False
    return True
