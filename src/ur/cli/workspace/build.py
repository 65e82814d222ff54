"""`ur build`: build the catkin workspace on this computer or on a robot."""

import base64
import signal
import subprocess
import sys
import zlib
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import click

from ur.cli.robots.fleet import ALL, choose_robots, is_fleet, run_for_each
from ur.request.remote.connection import connect_robot, robot_address
from ur.robot.deploy import build_attached
from ur.robot.deploy.build import FACTS, Builder, build_command, check_builder, choose_jobs, parse_builder
from ur.robot.ssh.shell import LocalShell, Shell, quote
from ur.source.diagnostic import UserError, error, error_about
from ur.source.progress_line import show_progress

END_SECONDS = 15.0  # longer than build_attached takes for all its steps


@click.command("build")
@click.argument("robots", nargs=-1, metavar="[ROBOT ...]")
@ALL
@click.option("--packages", multiple=True, metavar="NAME", help="Build only this package; may be repeated.")
@click.option("-j", "jobs", type=click.IntRange(1, 256), help="How many compilers at once. [default: as memory allows]")
def command(robots: tuple[str, ...], every: bool, packages: tuple[str, ...], jobs: int | None) -> int:
    """Build the catkin workspace here or on robots.

    Builds ~/catkin_ws of this computer, or of ROBOT, with catkin_make, or with catkin build if the workspace was made
    with it. Prints its output as it arrives; Ctrl-C ends it, also on the robot. Several robots build in parallel, with
    a line for each; then the output of failed builds follows. The exit code is that of the build, or the highest of
    several.
    """
    names = [name for each in packages for name in each.replace(",", " ").split()]
    chosen = choose_robots(robots, every=every)
    if is_fleet(chosen, every=every):
        options = [*(word for name in names for word in ("--packages", name)), *(["-j", str(jobs)] if jobs else [])]
        return run_for_each("build", chosen, lambda robot: ["build", robot, *options])
    if not chosen:
        with show_progress("examining the workspace"):
            builder = _look(LocalShell(), here=True)
        line = _prepare(builder, names, jobs)
        return run_attached([sys.executable, "-I", build_attached.__file__, line])
    with connect_robot(robot_address(chosen[0])) as shell:
        builder = _look(shell, here=False)
        line = _prepare(builder, names, jobs)
        source = base64.b64encode(zlib.compress(Path(build_attached.__file__).read_bytes())).decode()
        code = f"import base64,zlib;exec(zlib.decompress(base64.b64decode('{source}')))"
        done = run_attached([*shell.words, "--", shell.destination, quote("python3", "-I", "-c", code, line)])
    if done == 255:
        raise UserError(
            error_about(
                shell.destination,
                "the connection has ended, and the build with it",
                rule="lost-connection",
                help="ur doctor",
            )
        )
    return done


def _look(shell: Shell, *, here: bool) -> Builder:
    done = shell.run(quote("bash", "-lc", FACTS))
    builder = parse_builder(done.out)
    check_builder(builder, shell.destination, here=here)
    return builder


def _prepare(builder: Builder, names: Sequence[str], jobs: int | None) -> str:
    bad = [name for name in names if not name.replace("-", "").replace("_", "").isalnum()]
    if bad:
        raise UserError(
            error(
                f"{bad[0]!r} is not the name of a package", rule="no-build", help="rospack list-names", subject=bad[0]
            )
        )
    count, note = choose_jobs(builder, jobs)
    if note:
        click.echo(note, err=True)
    return build_command(builder, names, count)


def run_attached(argv: Sequence[str]) -> int:
    """Run a program that ends when its standard input closes; return its exit code.

    Ctrl-C ends it, and shows its output.
    """
    sys.stdout.flush()
    process = subprocess.Popen(argv, stdin=subprocess.PIPE, start_new_session=True)
    try:
        return process.wait()
    except KeyboardInterrupt:
        # A second interrupt would leave the program running.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if process.stdin:
            process.stdin.close()
        with suppress(subprocess.TimeoutExpired):
            process.wait(END_SECONDS)
        click.echo("interrupted: the build was ended", err=True)
        return 130
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
