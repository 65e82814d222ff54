"""Drivers of a real base: missing packages and their installation, before anything starts, and boards to know about."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.request.bases.base_argument import FileBase
from ur.robot.base import Base, UpstreamDriver, load_base
from ur.robot.base.own_drivers import NO_WATCHDOG, OWN_DRIVERS
from ur.source.diagnostic import Diagnostic, UserError, error


def check_drivers(bases: Iterable[FileBase], nodes: Sequence[NodeSpec], world: World) -> None:
    """Compare the packages of nodes with the drivers in the base file.

    Raises UserError with one finding for each driver package that is not installed on this computer.
    """
    unique = {each.package: each.base for each in bases}
    missing = [found for package in sorted(unique) for found in _missing(unique[package], nodes, world)]
    if missing:
        raise UserError(*missing)


def describe_board(node: NodeSpec, plan: Plan) -> str:
    """Return a warning about the board that a node drives with a driver of this project; '' for other nodes."""
    if node.type != "base_driver":
        return ""
    own = {
        each.name.rpartition("/")[2]: str(each.value)
        for each in plan.params
        if each.name.startswith(f"{node.full_name}/")
    }
    protocol = own.get("board", "")
    try:
        driver = load_base(own.get("package", ""), own.get("base", ""), own.get("variant", "")).driver
    except UserError:
        driver = None
    known = OWN_DRIVERS.get(protocol or (driver.protocol if driver else ""))
    return f"{known.what} has {NO_WATCHDOG}" if known and known.drives_on else ""


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
