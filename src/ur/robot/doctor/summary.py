"""Comparison of two computers side by side. Pure."""

from collections.abc import Mapping

from ur.robot.doctor.findings import ComputerPair
from ur.robot.doctor.rules.drivers import describe_driver, read_drivers
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import NAMES, Ros2, domain_of, middleware_of
from ur.system.ros import note_support


def summarize(pair: ComputerPair) -> list[tuple[str, str, str]]:
    """Return rows (property, value on this computer, value on the robot) of everything that was inspected."""
    local, remote = pair.local, pair.remote
    rows = [(what, left, right) for what, left, right in zip(_TITLES, _cells(local), _cells(remote), strict=True)]
    arrives = {True: "yes", False: "no"}
    rows += [
        ("a free port is reached", arrives[pair.reaches_local], arrives[pair.reaches_remote]),
        ("clock", "", f"{pair.offset:+.3f} s"),
        ("login from the other", pair.way_back or "by key", "refused" if pair.key_refused else "by key"),
        *[
            (f"node {one.node} at {one.host}", _list(one.local) or "nothing", _list(one.remote) or "nothing")
            for one in pair.advertised
        ],
    ]
    return rows


_TITLES = (
    *("computer", "system", "addresses", "the other's name means", "this shell", "a new terminal", "login to itself"),
    *(
        "full frames",
        "latency",
        "loss",
        "WiFi",
        "disk",
        "memory",
        "tool for the firewall",
        "X11 over ssh",
        "ROS",
        "ROS 2",
        "set up by ur",
        "workspace",
        "drivers",
    ),
)


def _cells(side: Side) -> list[str]:
    ms = "" if side.latency is None else f"{side.latency * 1000:.1f} ms"
    return [
        f"{side.user}@{side.name}",
        side.system,
        _list(side.addresses),
        _list(side.resolves) or "nothing",
        _variables(side.ros),
        _variables(side.shell),
        side.own_login or "by key",
        f"{_yes(side.full_frames)} ({side.device}, MTU {side.mtu})" if side.mtu else _yes(side.full_frames),
        ms,
        "" if side.loss is None else f"{side.loss:.0%}",
        ", ".join(f"{w.device} {w.band} {_number(w.signal, 'dBm')} {_number(w.rate, 'Mbit/s')}" for w in side.wifi)
        or "none",
        ", ".join(f"{disk.place} {disk.free:.0f} MB" for disk in side.disks),
        "" if side.memory_free is None else f"{side.memory_free:.0f} MB",
        side.firewall or "none",
        _yes(side.x11),
        side.packages.get("python3-roslaunch", "none"),
        "; ".join(describe_ros2(side.ros2)) or "none",
        side.ur,
        f"{len(side.workspace)} packages{', built' if side.built else ''}",
        "; ".join(map(describe_driver, read_drivers(side))) or "none run",
    ]


def describe_ros2(ros2: Ros2) -> list[str]:
    """Return lines about ROS 2 on a computer: releases, processes and domains; empty without ROS 2."""
    lines = [
        f"ROS 2 {NAMES.get(each.distro, each.distro)} in {each.folder}{note_support(each.distro)}"
        for each in ros2.installations
    ]
    if ros2.processes:
        where = f"domain {domain_of(ros2.variables)}, {middleware_of(ros2.variables)}"
        units = sorted({each.unit for each in ros2.processes if each.unit})
        by = f" ({', '.join(units)})" if units else ""
        lines.append(f"{_count(len(ros2.processes), 'process', 'processes')} of ROS 2 in {where}{by}")
    if ros2.graph:
        lines.append(
            f"{_count(len(ros2.graph.nodes), 'node', 'nodes')}, {_count(len(ros2.graph.topics), 'topic', 'topics')}"
        )
    return lines


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"


def _variables(variables: Mapping[str, str]) -> str:
    return " ".join(f"{name.removeprefix('ROS_')}={value}" for name, value in variables.items()) or "nothing of ROS"


def _list(texts: frozenset[str] | tuple[str, ...]) -> str:
    return ", ".join(sorted(texts))


def _yes(value: bool | None) -> str:
    return {True: "yes", False: "no", None: ""}[value]


def _number(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:g} {unit}"
