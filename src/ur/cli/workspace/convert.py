"""`ur convert`: launch files of ROS 1 as launch files of ROS 2, and those of ROS 2 in another language."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.source.printable import printable

if TYPE_CHECKING:
    from ur.tools.convert.other_language import Language
    from ur.tools.convert.package import ConvertedFiles


@click.command("convert")
@click.argument("path", metavar="PACKAGE|PATH")
@click.option("--output", metavar="DIR", help="Write the converted files there, as they lie in their package.")
@click.option("--prefix", metavar="DIR", help="Make a folder there from which `ros2 launch` starts the package.")
@click.option("--to", "language", type=click.Choice(["xml", "yaml"]), default="xml", help="Language to write.")
@click.option("--anyway", is_flag=True, help="Write files that do not start the same, too.")
def command(path: str, output: str | None, prefix: str | None, language: Language, *, anyway: bool) -> int:
    """Convert launch files of ROS 1 or Python to XML or YAML.

    PATH is a launch file, which is printed, or a package or folder, of which all launch files are converted, with the
    files of parameters that they load. Everything without a counterpart is reported with its position and what to do.

    A file of ROS 2 is not run. The converted one is read back, and is written only if both start the same with each
    flag and choice of the arguments; otherwise the difference is printed.

    With --prefix the folder also gets links to all other files of the package and to its programs; add it to
    AMENT_PREFIX_PATH, before that of ROS 2.

    Exit code: 0, or 1 when something could not be converted, or 2 when nothing was.
    """
    from ur.check.worlds import make_world
    from ur.request.environment import add_own_package
    from ur.source.diagnostic import user_error
    from ur.source.progress_line import show_progress
    from ur.source.render import render_human, shows_colour
    from ur.tools.convert.package import convert_all

    if output and prefix:
        raise user_error("--output with --prefix, expected one of them", rule="bad-options", help="leave one out")
    world = make_world([path], add_own_package(os.environ))
    with show_progress("converting launch files") as progress:
        whole = prefix is not None
        made = convert_all(path, world, progress, whole=whole, language=language, anyway=anyway)
    sys.stderr.write(render_human(made.findings, colour=shows_colour(sys.stderr)))
    if output or prefix:
        _write(made, Path(output or prefix or ""), whole=whole)
    elif len(made.launch_files) == 1:
        click.echo(made.launch_files[0].text, nl=False)
        if made.parameter_files:
            names = ", ".join(printable(os.path.relpath(each.path)) for each in made.parameter_files)
            click.echo(f"note: it loads files of parameters, which --output converts, too: {names}", err=True)
    else:
        message = f"{len(made.launch_files)} launch files, expected --output or --prefix with a folder for them"
        raise user_error(message, rule="bad-options", help=f"ur convert {path} --output FOLDER")
    return 1 if made.findings else 0


def _write(made: ConvertedFiles, folder: Path, *, whole: bool) -> None:
    from ur.tools.convert.write import write_output, write_prefix

    (write_prefix if whole else write_output)(made, folder)
    files = f"{len(made.launch_files)} launch files and {len(made.parameter_files)} files of parameters"
    click.echo(f"{files} converted to {printable(str(folder))}", err=True)
    if whole:
        names = sorted({each.package for each in made.launch_files if each.package})
        click.echo(f'  export AMENT_PREFIX_PATH="{printable(str(folder.absolute()))}:$AMENT_PREFIX_PATH"', err=True)
        example = Path(made.launch_files[0].path).name
        click.echo(f"  ros2 launch {' or '.join(names)} FILE, for example {example}", err=True)
