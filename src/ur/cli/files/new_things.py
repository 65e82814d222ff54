"""Facts that `ur new` gets from people and from this computer."""

from __future__ import annotations

import getpass
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence, Sized
from pathlib import Path

import click

from ur.cli.files.new_parts import Target
from ur.new.model import BaseRequest, NewFile, NodeRequest, Observed, Part
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

_FIGURES: dict[str, tuple[str, float]] = {
    "length": ("Length in m", 0.4),
    "width": ("Width in m", 0.35),
    "height": ("Height in m", 0.25),
    "mass": ("Mass in kg", 6.0),
    "wheel_radius": ("Radius of a driven wheel in m", 0.06),
    "wheel_separation": ("Separation of the driven wheels in m", 0.3),
    "velocity": ("Highest speed in m/s", 0.5),
    "angular_velocity": ("Highest turning speed in rad/s", 1.5),
}


def ask(value: str | None, option: str, question: str, default: str | None = None) -> str:
    """A value that was given, else what a person answers, else the default. Raises UserError where there is none."""
    if value:
        return value
    if not sys.stdin.isatty():
        raise UserError(
            error(
                f"{option} is required where there is no terminal to ask on",
                rule="not-given",
                help=f"give {option}: {question}",
            )
        )
    answer: str = click.prompt(question, default=default or None, type=str)
    return answer.strip()


def node_request(
    name: str, package: str, kind: str, summary: str, target: Target, seconds: float | None, per_base: bool,
    arguments: Sequence[str],
) -> NodeRequest:  # fmt: skip
    """The facts about a node; it is started and observed unless `seconds` is None."""
    from ur.robot.base import list_bases

    observed = Observed()
    program = find_program(package, kind)
    if seconds is not None:
        from ur.new.observe import observe_node
        from ur.source.progress_line import show_progress

        with show_progress(f"waiting for {kind} to register its topics and services"):
            observed = observe_node([program, *arguments], os.environ, seconds, lambda text: click.echo(text, err=True))
        click.echo(describe_observed(observed), err=True)
    return NodeRequest(name, package, kind, summary, "", observed, per_base, list_bases(target.folder))


def describe_observed(observed: Observed) -> str:
    """Say how much was seen of a node: 'seen: 2 topics, 1 service, 1 parameter'."""
    return (
        f"seen: {_count(observed.topics, 'topic')}, {_count(observed.services, 'service')}, "
        f"{_count(observed.parameters, 'parameter')}"
    )


def _count(things: Sized, noun: str) -> str:
    return f"{len(things)} {noun}{'' if len(things) == 1 else 's'}"


def find_program(package: str, kind: str) -> str:
    """The executable of a package. Raises UserError, did you mean."""
    from ur.launchfile.world.protocol import PackageNotFound
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import apply_selection, current_selection

    apply_selection(current_selection(os.environ))
    world = SystemWorld(os.environ)
    try:
        found = world.find_executables(package, kind)
    except PackageNotFound:
        near = did_you_mean(package, world.package_names())
        help_ = f"did you mean {near}?" if near else "install it, or source the setup.bash of its workspace"
        raise UserError(error(f"unknown package '{package}'", rule="unknown-package", help=help_)) from None
    if found:
        return found[0]
    names = sorted(world.executable_names(package))
    near = did_you_mean(kind, names)
    help_ = f"did you mean {near}?" if near else f"there is {', '.join(names) or 'none'}"
    raise UserError(error(f"no executable '{kind}' in package '{package}'", rule="missing-executable", help=help_))


def find_parts(names: Sequence[str], target: Target) -> list[Part]:
    """The launch files to include: `n_joy`, `m_robot_base`, `PACKAGE/n_x`. Raises UserError, did you mean."""
    from ur.launchfile.query.arguments import read_arguments
    from ur.launchfile.world.protocol import PackageNotFound
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import apply_selection, current_selection

    apply_selection(current_selection(os.environ))
    world = SystemWorld({**os.environ, "ROS_PACKAGE_PATH": f"{target.folder}:{os.environ.get('ROS_PACKAGE_PATH', '')}"})
    parts = []
    for given in names:
        package, _, name = given.rpartition("/")
        owners = [package] if package else dict.fromkeys((target.name, "ubiquity_launches"))
        for owner in owners:
            try:
                folder = world.find_package(owner)
            except PackageNotFound:
                continue
            path = f"{folder}/{name}/launch/{name}.launch.xml"
            if world.is_file(path):
                found = {each.name: each for each in read_arguments(path, ["robot_base:=stage"], world)}
                known = {name: each.default for name, each in found.items()}
                docs = {name: each.doc for name, each in found.items()}
                parts.append(Part(f"$(find {owner})/{name}/launch/{name}.launch.xml", known, docs))
                break
        else:
            folders = {each.name for each in target.folder.glob("[nm]_*")} | _ours(world.find_package)
            near = did_you_mean(name, folders)
            message = f"{given}: no launch directory of this name, expected n_x, m_x or PACKAGE/n_x"
            raise UserError(error(message, rule="missing-file", help=f"did you mean {near}?" if near else None))
    return parts


def _ours(find: object) -> set[str]:
    assert callable(find)
    return {each.name for each in Path(find("ubiquity_launches")).glob("[nm]_*")}


def base_request(
    name: str, summary: str, figures: Mapping[str, float | None], *, lidar: bool, raspicam: bool
) -> BaseRequest:
    """The figures of a base: those given, else those a person answers, else ordinary ones."""
    answers = {}
    for key, (question, ordinary) in _FIGURES.items():
        given = figures.get(key)
        if given is None and sys.stdin.isatty():
            given = click.prompt(question, default=ordinary, type=float)
        answers[key] = ordinary if given is None else given
    return BaseRequest(name, summary, lidar=lidar, raspicam=raspicam, **answers)


def urdf_files(target: Target, name: str, text: str, like: str) -> list[NewFile]:
    """The files of a new base beside its base.yaml: a parameter file wherever base `like` has one, and its URDF.

    Raises UserError when the figures make no base, or `like` is not known in the package.
    """
    from ur.robot.base import list_bases, read_base
    from ur.robot.base.body_mesh import make_body, write_stl
    from ur.robot.base.urdf import write_urdf

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "base.yaml"
        path.write_text(text, encoding="utf-8")
        base = read_base(path, name)
    known = list_bases(target.folder)
    if known and like not in known:
        near = did_you_mean(like, known)
        message = f"--like {like}: unknown base {like!r}, expected one of {', '.join(known)}"
        raise UserError(error(message, rule="unknown-base", help=f"did you mean {near}?" if near else None))
    files = [
        NewFile(str(each.relative_to(target.folder).with_name(f"{name}.yaml")), each.read_text(encoding="utf-8"))
        for each in sorted(target.folder.glob(f"*/params/{like}.yaml"))
        if each.parts[-3] != "n_stage_ros"
    ]
    if (target.folder / "n_robot_state_publisher").is_dir():
        mesh = f"n_robot_state_publisher/meshes/{name}.stl"
        files.append(NewFile(mesh, write_stl(make_body(base))))
        urdf = write_urdf(base, f"package://{target.name}/{mesh}")
        files.append(NewFile(f"n_robot_state_publisher/urdf/{name}.urdf", urdf))
    return files


def know_person() -> tuple[str, str]:
    """Name and address of the user, as git knows them."""

    def git(key: str) -> str:
        try:
            done = subprocess.run(["git", "config", key], capture_output=True, text=True, check=False)
        except OSError:
            return ""
        return done.stdout.strip()

    return git("user.name") or re.sub(r"\W", "", getpass.getuser()), git("user.email")
