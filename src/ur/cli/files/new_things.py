"""Input of `ur new` from the user and from this computer."""

from __future__ import annotations

import getpass
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence, Sized
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.request.environment import add_own_package, apply_selection, current_selection
from ur.source.diagnostic import UserError, user_error
from ur.source.read import read_source
from ur.source.suggest import did_you_mean, suggest
from ur.tools.new import description as files
from ur.tools.new.description import FIGURES, check_figure
from ur.tools.new.parts import BaseRequest, IncludedPart, NewFile, NodeRequest, Observed, write_files
from ur.tools.new.target import TargetPackage, find_target

if TYPE_CHECKING:
    from ur.robot.description.reading import DescriptionReading


def ask(value: str | None, option: str, question: str, default: str | None = None) -> str:
    """Return the given value, else the user's answer, else the default. Raises UserError if there is none."""
    if value:
        return value
    if not sys.stdin.isatty():
        raise user_error(
            f"{option} is required where there is no terminal to ask on",
            rule="not-given",
            help=f"give {option}: {question}",
            subject=option,
        )
    answer: str = click.prompt(question, default=default or None, type=str)
    return answer.strip()


def node_request(
    name: str, package: str, kind: str, summary: str, seconds: float | None, arguments: Sequence[str]
) -> NodeRequest:
    """Return the facts about a node; it is started and observed unless `seconds` is None."""
    observed = Observed()
    program = find_program(package, kind)
    if seconds is not None:
        from ur.source.progress_line import show_progress
        from ur.tools.new.node_defaults import add_defaults, read_defaults
        from ur.tools.new.observe import observe_node

        with show_progress(f"waiting for {kind} to register its topics and services"):
            observed = observe_node([program, *arguments], os.environ, seconds, lambda text: click.echo(text, err=True))
        observed = add_defaults(observed, read_defaults(_source(program)))
        click.echo(describe_observed(observed), err=True)
    return NodeRequest(name, package, kind, summary, observed)


def _source(program: str) -> str:
    """Return the text of a program, '' if it is not text."""
    try:
        return read_source(program).text
    except UserError:
        return ""


def describe_observed(observed: Observed) -> str:
    """Describe the observed interface of a node: 'seen: 2 topics, 1 service, 1 parameter'."""
    return (
        f"seen: {_count(observed.topics, 'topic')}, {_count(observed.services, 'service')}, "
        f"{_count(observed.parameters, 'parameter')}"
    )


def _count(things: Sized, noun: str) -> str:
    return f"{len(things)} {noun}{'' if len(things) == 1 else 's'}"


def find_program(package: str, kind: str) -> str:
    """Find the executable of a package. Raises UserError, with a suggestion of a similar name."""
    from ur.launchfile.world.protocol import PackageNotFound
    from ur.launchfile.world.system import SystemWorld

    apply_selection(current_selection(os.environ))
    world = SystemWorld(os.environ)
    try:
        found = world.find_executables(package, kind)
    except PackageNotFound:
        near = did_you_mean(package, world.package_names())
        help_ = f"did you mean {near}?" if near else "install it, or source the setup.bash of its workspace"
        raise user_error(f"unknown package '{package}'", rule="unknown-package", help=help_, subject=package) from None
    if found:
        return found[0]
    names = sorted(world.executable_names(package))
    near = did_you_mean(kind, names)
    help_ = f"did you mean {near}?" if near else f"there is {', '.join(names) or 'none'}"
    raise user_error(
        f"no executable '{kind}' in package '{package}'", rule="missing-executable", help=help_, subject=kind
    )


def find_parts(names: Sequence[str], target: TargetPackage) -> list[IncludedPart]:
    """Find the launch files to include: `n_joy`, `m_robot_base`, `PACKAGE/n_x`.

    Raises UserError, with a suggestion of a similar name.
    """
    from ur.launchfile.query.arguments import read_arguments
    from ur.launchfile.world.protocol import PackageNotFound

    apply_selection(current_selection(os.environ))
    from ur.launchfile.world.system import SystemWorld

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
                parts.append(IncludedPart(f"$(find {owner})/{name}/launch/{name}.launch.xml", known, docs))
                break
        else:
            folders = {each.name for each in target.folder.glob("[nm]_*")} | _ours(world.find_package)
            message = f"{given}: no launch directory of this name, expected n_x, m_x or PACKAGE/n_x"
            raise user_error(message, rule="missing-file", help=suggest(name, folders))
    return parts


def _ours(find: object) -> set[str]:
    assert callable(find)
    return {each.name for each in Path(find("ubiquity_launches")).glob("[nm]_*")}


def base_request(
    name: str, summary: str, figures: Mapping[str, float | None], *, lidar: bool, raspicam: bool
) -> BaseRequest:
    """Return the properties of a base: given ones, else the user's answers, else defaults. Raises UserError."""
    for key, given in figures.items():
        check_figure(key, given)
    answers = {}
    for key, (question, ordinary, _) in FIGURES.items():
        given = figures.get(key)
        if given is None and sys.stdin.isatty():
            given = check_figure(key, click.prompt(question, default=ordinary, type=float), asked=True)
        answers[key] = ordinary if given is None else given
    return BaseRequest(name, summary, lidar=lidar, raspicam=raspicam, **answers)


def check_like(library: Path, name: str, like: str | None) -> str | None:
    """Return the base whose parameter files are copied: by default `stage`, if the package has it. Raises UserError."""
    from ur.robot.base import list_bases

    known = list_bases(library)
    if like is None:
        return "stage" if "stage" in known else None
    if like in known:
        return like
    help_ = suggest(like, known) or (None if known else "leave --like out")
    expected = f"expected one of {', '.join(known)}" if known else f"package '{name}' has no bases yet"
    raise user_error(f"unknown base '{like}' for --like, {expected}", rule="unknown-base", help=help_, subject=like)


def urdf_files(
    target: TargetPackage, name: str, text: str, like: str | None, library: Path, url: str = "",
    navigation: tuple[float, float] | None = None,
) -> list[NewFile]:  # fmt: skip
    """Return the files of a new base besides its base.yaml: its URDF, and the parameter files that base `like` has.

    `library` is the package of `like`; `url` is the URL of the files' folder, unless it is a package. `navigation`: see
    `fit_parameters`.
    """
    from ur.robot.base import read_base
    from ur.robot.base.body_mesh import make_body, write_stl
    from ur.robot.base.parameters import fit_parameters
    from ur.robot.base.urdf import write_urdf

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "base.yaml"
        path.write_text(text, encoding="utf-8")
        base = read_base(path, name)
    files = [
        NewFile(
            str(each.relative_to(library).with_name(f"{name}.yaml")),
            fit_parameters(each.read_text(encoding="utf-8"), like, base, navigation),
        )
        for each in sorted(library.glob(f"*/params/{like}.yaml"))
        if like is not None and each.parts[-3] != "n_stage_ros"
    ]
    if (library / "n_robot_state_publisher").is_dir():
        mesh = f"n_robot_state_publisher/meshes/{name}.stl"
        files.append(NewFile(mesh, write_stl(make_body(base))))
        urdf = write_urdf(base, f"{url or f'package://{target.name}'}/{mesh}")
        files.append(NewFile(f"n_robot_state_publisher/urdf/{name}.urdf", urdf))
    return files


def know_person() -> tuple[str, str]:
    """Return name and e-mail address of the user, as configured in git."""

    def git(key: str) -> str:
        try:
            done = subprocess.run(["git", "config", key], capture_output=True, text=True, check=False)
        except OSError:
            return ""
        return done.stdout.strip()

    return git("user.name") or re.sub(r"\W", "", getpass.getuser()), git("user.email")


SUMMARY = click.option("--summary", help="One line that says what it does.")
in_package = click.option(
    "--package", "-p", help="Name or folder of the package; without it the one around this folder."
)


class _Done:
    """Writes files, and prints their names and the next steps."""

    def __call__(self, target: TargetPackage, files: Sequence[NewFile], then: str) -> int:
        files = [_formatted(target, file) for file in files]
        write_files(target.folder, files)
        for file in files:
            click.echo(f"wrote {os.path.relpath(target.folder / file.path)}")
        click.echo(f"next: ur check {os.path.relpath(target.folder)}, then {then}", err=True)
        return 0

    @staticmethod
    def target(place: str | None) -> TargetPackage:
        """Return the package with a name or folder, or the one around the current folder. Raises UserError."""
        return find_target(place)

    @staticmethod
    def folder(name: str) -> TargetPackage:
        """Return the target of a new package. Raises UserError if the folder exists."""
        folder = Path.cwd() / name
        if folder.exists():
            raise user_error(f"{name} is there already, expected a new name", rule="file-exists", subject=name)
        return TargetPackage(name, folder)


show_done = _Done()


def _formatted(target: TargetPackage, file: NewFile) -> NewFile:
    if isinstance(file.text, bytes) or not file.path.endswith((".launch", ".launch.xml")):
        return file
    from dataclasses import replace

    from ur.check.worlds import make_world
    from ur.tools.format.run import format_file

    path = str(target.folder / file.path)
    return replace(
        file,
        text=format_file(path, file.text.encode(), make_world([str(target.folder)], add_own_package(os.environ))).text,
    )


def describe_base(
    source: Path, summary: str | None, figures: Mapping[str, float | None], arguments: Sequence[str], *,
    lidar: bool | None, raspicam: bool,
) -> tuple[str, tuple[float, float]]:  # fmt: skip
    """Return the text of a base.yaml for a description, and the `navigation` of it. Raises UserError.

    Prints the properties that were read; asks once for the others. `lidar` tells whether the robot has one; None if the
    file defines it. `arguments` are those of a xacro file.
    """
    from ur.robot.description.base_text import limits_of, write_base_file
    from ur.robot.description.reading import read_base_figures
    from ur.robot.description.speed_files import find_speeds

    if raspicam:
        message = "--raspicam has no effect with --from, which reads the camera from the file"
        raise user_error(message, rule="bad-value", help="add it to the base.yaml that is written")
    given = {key: files.check_measured(key, value) for key, value in figures.items() if value is not None}
    files.check_arguments(source, arguments)
    around = files.look_around(source)
    loaded = files.load_file(source, around, arguments, consent=_ask_to_run)
    description, speeds = loaded.description, find_speeds(around)
    reading = read_base_figures(description, given, lidar=lidar, speeds=speeds)
    click.echo(files.describe_reading(reading), err=True, nl=False)
    for note in files.describe_left_out(loaded, around):
        click.echo(note, err=True)
    if lidar is None and not reading.has_lidar:
        lidar = _ask_for_lidar(reading)
    while reading.open:
        given |= _ask_for(source, reading, lidar)
        reading = read_base_figures(description, given, lidar=lidar, speeds=speeds)
    if lidar is not None:
        reading = read_base_figures(description, given, lidar=lidar, speeds=speeds)
    click.echo(f"stop: {limits_of(reading).describe_stop()}", err=True)
    text = write_base_file(reading, summary or f"Robot {reading.name or source.stem}.", source.name)
    return text, reading.navigation


def _ask_for_lidar(reading: DescriptionReading) -> bool | None:
    """Ask the user about a lidar; None without a terminal, and then the robot has none."""
    while sys.stdin.isatty():
        question = "the file has no lidar, which navigation requires; add a typical one on top? [Y/n]"
        answer = click.prompt(question, default="y", show_default=False, type=str).strip().lower()
        if answer in ("y", "yes", "n", "no"):
            return answer[0] == "y"
        click.echo(f"error: '{answer}' is no answer, expected y or n", err=True)
    if not reading.open:
        note = "note: the file has no lidar, which navigation requires; --lidar adds a typical one"
        click.echo(f"{note}, and without it: ur run keyboard_drive", err=True)
    return None


def _ask_to_run(what: str) -> bool:
    """Ask whether Python code of a description may run with all rights; without a terminal the answer is no."""
    if not sys.stdin.isatty():
        return False
    click.echo(f"warning: {what}", err=True)
    answer = click.prompt("run it? [y/N]", default="n", show_default=False, type=str).strip().lower()
    return answer in ("y", "yes")


def _ask_for(source: Path, reading: DescriptionReading, lidar: bool | None) -> dict[str, float]:
    """Ask the user for the open properties; without a terminal one error names all of them."""
    if sys.stdin.isatty():
        return {key: _prompt(key) for key in reading.open}
    raise files.missing_figures(source, reading, lidar)


def _prompt(key: str) -> float:
    from ur.robot.description.reading import MEASURES, QUESTIONS

    least, most = QUESTIONS[key]
    click.echo(f"how to measure it: {MEASURES[key]}", err=True)
    while True:
        question = f"{files.FIGURES[key][0]} ({least:g} to {most:g})"
        answer = click.prompt(question, default=f"{files.usual_figure(key):g}", type=str)
        try:
            return files.check_measured(key, files.read_number(key, answer), asked=True)
        except UserError as problem:
            click.echo(f"error: {problem.diagnostics[0].message}", err=True)
