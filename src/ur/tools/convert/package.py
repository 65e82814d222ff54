"""Conversion of a launch file, or of all below a folder, with the place of each file in its package."""

from dataclasses import dataclass

from ur.check.collect import Targets, collect_targets
from ur.launchfile.load import is_for_ros2
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Severity, UserError, user_error_about
from ur.source.progress import Progress, counted
from ur.tools.convert.other_language import Language, convert_to
from ur.tools.convert.run import Converted, convert_file
from ur.tools.convert.state import RULE


@dataclass(frozen=True, slots=True)
class ConvertedFile:
    """A converted file: where it was, the package that it belongs to, its place there, and its text."""

    path: str
    package: str
    place: str
    text: str


@dataclass(frozen=True, slots=True)
class ConvertedFiles:
    """All converted files, and what could not be converted. `packages` are folders by the names of packages."""

    launch_files: tuple[ConvertedFile, ...]
    parameter_files: tuple[ConvertedFile, ...]
    packages: dict[str, str]
    findings: tuple[Diagnostic, ...]


def convert_all(
    path: str,
    world: World,
    progress: Progress,
    *,
    whole: bool = False,
    language: Language = "xml",
    anyway: bool = False,
) -> ConvertedFiles:
    """Convert a launch file or all of a package or folder; `whole`: packages only. Raises UserError.

    Where there are launch files of ROS 1 these are converted to ROS 2; otherwise those of ROS 2 to `language`, without
    those for which something has no counterpart, unless `anyway`.
    """
    targets = collect_targets([path], world)
    of_ros1 = tuple(each for each in targets.launch_files if not is_for_ros2(each, world))
    others = tuple(each for each in targets.launch_files if not each.endswith(f".{language}"))
    targets = targets._replace(launch_files=of_ros1 or others)
    if not targets.launch_files:
        reason = "no launch file in it, expected one to convert"
        help_ = "launch files end in .launch, .launch.xml, .launch.yaml or .py"
        raise user_error_about(path, reason, rule="missing-file", help=help_)
    made: list[Converted] = []
    findings: list[Diagnostic] = []
    for each in counted(targets.launch_files, "converting", "launch files", progress):
        try:
            converted = convert_file(each, world) if of_ros1 else convert_to(each, world, language)
            if of_ros1 or anyway or not converted.findings:
                made.append(converted)
            else:
                findings += converted.findings
        except UserError as problem:  # noqa: PERF203 - the other files are converted
            if len(targets.launch_files) == 1:
                raise
            findings += problem.diagnostics
    if not made:
        raise UserError(*findings)
    launch_files = tuple(_place(each.path, each.text, targets, world) for each in made)
    names = {each.package for each in launch_files}
    if whole and "" in names:
        reason = "not in a package, expected launch files of one"
        raise user_error_about(path, reason, rule="not-in-a-package", help="--output converts them where they are")
    loaded = {each.path: each.text for converted in made for each in converted.files}
    parameters = [_place(each, text, targets, world) for each, text in sorted(loaded.items())]
    findings += [found for each in made for found in each.findings]
    findings += [_elsewhere(each) for each in parameters if each.package not in names]
    packages = {package.name: folder for folder, package in targets.packages.items() if package.name in names}
    kept = tuple(each for each in parameters if each.package in names)
    return ConvertedFiles(launch_files, kept, packages, tuple(findings))


def _place(path: str, text: str, targets: Targets, world: World) -> ConvertedFile:
    path = world.absolute(path)
    package = targets.package_of(path)
    if package is None:
        return ConvertedFile(path, "", path.rpartition("/")[2], text)
    return ConvertedFile(path, package.name, path.removeprefix(package.folder + "/"), text)


def _elsewhere(file: ConvertedFile) -> Diagnostic:
    message = f"{file.path}: parameters of another package, which are not converted"
    return Diagnostic(Severity.WARNING, message, RULE, help="convert that package, too", subject=file.path)
