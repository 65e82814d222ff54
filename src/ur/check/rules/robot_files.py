"""Rules about YAML files of bases, worlds and maps: their readers must accept them."""

from __future__ import annotations

import errno
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ur.check.rule import Example, Rule, RuleFinding, RuleGroup, YamlView
from ur.check.rules.files import is_plain_yaml
from ur.source.diagnostic import Severity, UserError
from ur.source.file import Span

if TYPE_CHECKING:
    from ur.source.section import Section

_KEY = re.compile(r"^([a-z_]+):", re.MULTILINE)
_WORLD_KEYS = frozenset({"wall_height", "floor_friction", "boxes", "obstacles", "fiducials", "drops"})


def _find_bad_base(view: YamlView) -> Iterable[RuleFinding]:
    place = view.source.path.split("/")
    if place[-1] != "base.yaml" or place[-3:-2] != ["bases"]:
        return
    if not view.source.text.strip():
        message = "an empty file, expected a base file"
        yield RuleFinding(Span(view.source, 0, 1), message, f"delete the folder, then: ur new base {place[-2]}")
    elif _keys(view) & {"footprint", "wheels"}:
        from ur.robot.base.files import read_base_section  # imported where there is such a file, as below

        yield from _find_unusable(view, "a base file", lambda top: read_base_section(top, place[-2]))


def _find_bad_world(view: YamlView) -> Iterable[RuleFinding]:
    keys = _keys(view)
    if "floor_plan" in keys or ("image" in keys and keys & _WORLD_KEYS):
        from ur.worlds.world_file import check_world

        def check(top: Section) -> None:
            check_world(top, Path(view.source.path))
            if top.has("image"):
                _refuse_special(view, top)

        yield from _find_unusable(view, "a world file", check)


def _find_bad_map(view: YamlView) -> Iterable[RuleFinding]:
    if is_map(view):
        from ur.worlds.map_file import parse_map_file

        def check(top: Section) -> None:
            parse_map_file(top, Path(view.source.path).parent)
            _refuse_special(view, top)

        yield from _find_unusable(view, "a map file", check)


def _refuse_special(view: YamlView, top: Section) -> None:
    """Raise UserError where the picture of a map is a device, a pipe or a folder."""
    path = str(Path(view.source.path).parent / top.text("image"))
    if view.world.is_file(path):
        return
    try:
        view.world.read_bytes(path)
    except OSError as problem:
        if problem.errno == errno.EINVAL:
            top.fail("image", f"{path}: {problem.strerror}, expected a picture")


def is_map(view: YamlView) -> bool:
    """Return whether a YAML file is a map of map_server, by its keys."""
    keys = _keys(view)
    return {"image", "resolution"} <= keys and not keys & _WORLD_KEYS


def _keys(view: YamlView) -> set[str]:
    return {*_KEY.findall(view.source.text)} if is_plain_yaml(view.source) else set()


def _find_unusable(view: YamlView, what: str, read: Callable[[Section], object]) -> Iterable[RuleFinding]:
    from ur.source.section import parse_section

    try:
        read(parse_section(view.source, what))
    except UserError as problem:
        for found in problem.diagnostics:
            if found.rule != "bad-yaml":  # a rule of its own speaks of it
                yield RuleFinding(
                    found.span or Span(view.source, 0, 1), found.message, found.help or _HELP[what], found.notes
                )


_HELP = {
    "a base file": "docs/how-to/describe-a-base.md describes the keys",
    "a world file": "the files in n_simulator/worlds show the keys",
    "a map file": "the keys are those of map_server",
}
_BASE = """summary: A robot of two wheels.
footprint: [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]
height: 0.25
ground_clearance: 0.04
mass: 8.0
wheels: {radius: 0.08, width: 0.03, separation: 0.32, mass: 0.4}
casters: []
limits:
  {velocity: 0.5, angular_velocity: 1.0, acceleration: 1.0, angular_acceleration: 3.0,
   deceleration: 4.5, angular_deceleration: 10.0, command_age: 0.08}
odometry: {rate: 30, ticks_per_turn: 2048, wheel_noise: 0.002, radius_error: 0.003, separation_error: 0.005}
"""
_MAP = """image: office.png
resolution: 0.05
origin: [-5.0, -5.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.2
"""
_WORLD = """floor_plan: ../maps/office.yaml
boxes:
  - {name: desk, pose: [1.0, 2.0, 0.4, 0.0], size: [1.2, 0.6, 0.8]}
"""

RULES = (
    Rule(
        id="bad-base",
        group=RuleGroup.YAML,
        severity=Severity.ERROR,
        summary="A base file cannot be used.",
        explanation="""
`bases/NAME/base.yaml` describes a robot; everything that starts with that base reads it, with each of its variants.
""",
        bad=(
            Example({"bases/cube/base.yaml": _BASE.replace("mass: 8.0", "mass: «heavy»")}),
            Example({"bases/cube/base.yaml": "«\n»"}),
        ),
        good=(Example({"bases/cube/base.yaml": _BASE}),),
        yaml_file=_find_bad_base,
    ),
    Rule(
        id="bad-map",
        group=RuleGroup.YAML,
        severity=Severity.ERROR,
        summary="A map file cannot be used.",
        explanation="""
`map_server` and the simulator read a map from a YAML file with `image`, `resolution`, `origin`, `negate`,
`occupied_thresh` and `free_thresh`. The image itself is not looked at.
""",
        bad=(Example({"maps/office.yaml": _MAP.replace("free_thresh: 0.2", "free_thresh: «0.9»")}),),
        good=(Example({"maps/office.yaml": _MAP}),),
        yaml_file=_find_bad_map,
    ),
    Rule(
        id="bad-world",
        group=RuleGroup.YAML,
        severity=Severity.ERROR,
        summary="A world file cannot be used.",
        explanation="""
The simulator reads a world from a YAML file with a `floor_plan`, or with the keys of a map, and with `boxes`,
`obstacles`, `fiducials` and `drops`.
""",
        bad=(Example({"worlds/office.yaml": _WORLD.replace("[1.2, 0.6, 0.8]", "«[1.2, 0.6]»")}),),
        good=(Example({"worlds/office.yaml": _WORLD}),),
        yaml_file=_find_bad_world,
    ),
)
