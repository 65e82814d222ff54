"""The robot base of launch files: loaded once, and compared with the needs of the files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.request.launch_request import LaunchFiles
from ur.robot.base import SENSORS, Base, UpstreamDriver, list_bases, list_variants, load_base
from ur.robot.base.files import find_base_package
from ur.robot.base.own_drivers import NO_WATCHDOG, OWN_DRIVERS
from ur.source.diagnostic import Diagnostic, UserError, error, user_error
from ur.source.project import launch_library


@dataclass(frozen=True, slots=True)
class FileBase:
    """The base of a launch file; `package` is the one that describes it."""

    path: str
    package: Path
    base: Base


def find_bases(
    files: LaunchFiles, values: Mapping[str, str], load: Callable[[Path, str, str], Base] = load_base
) -> tuple[FileBase, ...]:
    """Load the base that `robot_base` and `robot_variant` name, from the package that each file belongs to.

    Packages without folder `bases` are skipped; bases that workspaces add are found, too. Raises UserError for an
    unknown base or variant, or an invalid base file.
    """
    name = values.get("robot_base")
    if name is None:
        return ()
    loaded: dict[Path, Base] = {}
    found = []
    for path in files.paths:
        own = find_package(path)
        if own is None:
            continue
        package = find_base_package(own, name, files.world.environment)
        if package not in loaded:
            loaded[package] = load(package, name, values.get("robot_variant", ""))
        found.append(FileBase(path, package, loaded[package]))
    return tuple(found)


def check_bases(files: LaunchFiles, bases: Sequence[FileBase]) -> None:
    """Raise UserError for a base without something that the comment `<!--Needs: ...-->` of its file names."""
    for each in bases:
        needs = find_needs(files.parse(each.path))
        lacks = list_lacks(each.base, needs)
        if lacks:
            raise _lack(each.path, each.package, each.base, needs, lacks)


def find_package(path: str) -> Path | None:
    """Return the folder of the package that a launch file belongs to, if it has bases."""
    for folder in Path(path).resolve().parents:
        if (folder / "package.xml").is_file():
            return folder if (folder / "bases").is_dir() else None
    return None


def _lack(path: str, package: Path, base: Base, needs: Sequence[Need], lacks: Sequence[Need]) -> UserError:
    whole = f"{base.name!r}, variant {base.variant!r}," if base.variant else f"{base.name!r}"
    wanted = " and ".join(describe_need(need) for need in lacks)
    variants = find_variants(package, base, needs)
    if not variants:
        able = [name for name in list_bases(package) if not list_lacks(load_base(package, name), needs)]
        help_ = f"choose another base: robot_base:={able[0]}" if able else "choose another base"
        help_ += f", or {', '.join(able[1:])}" if able[1:] else ""
    elif variants[0]:
        help_ = f"its variant {variants[0]!r} has what is needed: robot_variant:={variants[0]}"
    else:
        help_ = "the plain base, without a variant, has what is needed"
    message = f"{Path(path).name} needs {wanted}, and base {whole} has none"
    return user_error(message, rule="base-lacks", help=help_)


NEEDS = "Needs:"
Need = tuple[str, ...]
"""Alternatives: a base that has one of them has what is needed."""


def read_needs(path: str, world: World) -> tuple[Need, ...]:
    """Return the needs of a file, as `find_needs` does; empty if it cannot be read."""
    try:
        return find_needs(parse_launch_file(path, world.read_bytes(path)))
    except OSError:
        return ()


def find_needs(parsed: LaunchFile) -> tuple[Need, ...]:
    """Return the needs that a comment directly in `<launch>` names, in order."""
    launch = parsed.launch
    texts = [comment.text for comment in launch.comments] if launch is not None else []
    names = [
        name for text in texts if text.startswith(NEEDS) for name in text.removeprefix(NEEDS).replace(",", " ").split()
    ]
    return tuple(tuple(name.split("|")) for name in names)


def list_lacks(base: Base, needs: Sequence[Need]) -> tuple[Need, ...]:
    """Return the needs that a base does not meet."""
    return tuple(need for need in needs if not any(getattr(base, name, None) for name in need))


def find_variants(package: Path, base: Base, needs: Sequence[Need]) -> tuple[str, ...]:
    """Return the variants of the same base that meet all needs, '' for the plain one."""
    variants = ("", *list_variants(package, base.name))
    return tuple(each for each in variants if not list_lacks(load_base(package, base.name, each), needs))


def describe_need(need: Need) -> str:
    """Describe a need: `a lidar`, `a lidar or sonars`."""
    return " or ".join(f"{SENSORS[name].article} {name}".strip() if name in SENSORS else name for name in need)


def describe_lack(base: Base, lacks: Sequence[Need]) -> str:
    """Describe unmet needs as a clause: `magni has no lidar, no sonars`. `lacks` must not be empty."""
    names = ", ".join(f"no {name}" for need in lacks for name in need)
    return f"{describe_base(base)} has {names}"


def describe_base(base: Base) -> str:
    """Return a base and its variant, as `ur use` writes them: `magni:lidar`."""
    return f"{base.name}:{base.variant}" if base.variant else base.name


def check_drivers(bases: Iterable[FileBase], nodes: Sequence[NodeSpec], world: World) -> None:
    """Compare the packages of nodes with the drivers in the base file.

    Raises UserError with one finding for each driver package that is not installed on this computer.
    """
    unique = {each.package: each.base for each in bases}
    missing = [found for package in sorted(unique) for found in _missing(unique[package], nodes, world)]
    if missing:
        raise UserError(*missing)


def describe_base_of(node: NodeSpec, plan: Plan) -> str:
    """Return how the base of a mux stops, or a warning about the board of a driver of this project; else ''."""
    if node.type not in ("base_driver", "cmd_vel_mux"):
        return ""
    own = {
        each.name.rpartition("/")[2]: str(each.value)
        for each in plan.params
        if each.name.startswith(f"{node.full_name}/")
    }
    protocol = own.get("board", "")
    try:
        base = load_base(own.get("package", "") or launch_library(), own.get("base", ""), own.get("variant", ""))
    except UserError:
        base = None
    if node.type == "cmd_vel_mux":
        return f"{base.name} {base.limits.describe_stop()}" if base else ""
    known = OWN_DRIVERS.get(protocol or (base.driver.protocol if base and base.driver else ""))
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
