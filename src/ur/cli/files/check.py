"""`ur check`: problems in launch files, YAML files and programs."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.source.render import shows_colour

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ur.check.session import CheckReport


@click.command("check")
@click.argument("paths", nargs=-1, metavar="[PATH]... [NAME:=VALUE]...")
@click.option("--select", multiple=True, metavar="RULE", help="Check only these rules or groups; may be repeated.")
@click.option("--ignore", multiple=True, metavar="RULE", help="Leave out these rules or groups; may be repeated.")
@click.option("--fix", is_flag=True, help="Repair what can be repaired safely.")
@click.option("--strict", is_flag=True, help="End with exit code 1 for warnings, too.")
@click.option(
    "--format",
    "form",
    type=click.Choice(["human", "json", "github"]),
    default="human",
    show_default=True,
    help="How findings are printed.",
)
@click.option("--no-cache", is_flag=True, help="Check everything again, and write nothing to the cache.")
@click.option(
    "--explain",
    is_flag=False,
    flag_value="",
    metavar="[RULE]",
    help="Print the page of a rule and check nothing; without a rule, list all.",
)
@click.option("--package", is_flag=True, help="Compare package.xml and CMakeLists.txt with what launch files use.")
def command(
    paths: tuple[str, ...],
    select: tuple[str, ...],
    ignore: tuple[str, ...],
    fix: bool,
    strict: bool,
    form: str,
    no_cache: bool,
    explain: str | None,
    package: bool,
) -> int:
    """Check launch files, YAML files and programs.

    Required arguments need not be given, and packages with bases are checked for every base and variant.

    With --package, every package that a launch file or program uses has to be a dependency, and all of them have to be
    installed; --fix adds what is missing. A comment in package.xml lists optional packages: <!--ur: optional NAME NAME:
    REASON-->.

    Exit code: 0 when no error is found, 1 when there is one (with --strict: or a warning), 2 when the check could not
    run or there was nothing to read.
    """
    from ur.check.catalogue import choose_rules, find_rule, list_rules
    from ur.check.render.pages import explain_rule

    if explain is not None:
        click.echo(explain_rule(find_rule(explain)) if explain else list_rules(), nl=False)
        return 0
    if package:
        if len(paths) > 1:
            raise click.UsageError("--package checks one package")

        return check_package(paths[0] if paths else ".", fix)
    report = _check(paths, choose_rules(_words(select), _words(ignore)), form, fix=fix, cached=not no_cache)
    return 2 if not report.files else 1 if report.errors or (strict and report.findings) else 0


def _check(paths: Sequence[str], chosen: frozenset[str], form: str, *, fix: bool, cached: bool) -> CheckReport:
    """Check and print."""
    from ur.check.cache.store import cache_folder, digest_program, load_recall, name_cache, store_recall
    from ur.check.rule import describe_left_out
    from ur.check.session import check_paths
    from ur.check.worlds import make_world
    from ur.request.environment import add_own_package
    from ur.source.arguments import split_argv, values_of
    from ur.source.progress_line import show_progress

    names, arguments = split_argv(paths)
    places, values = list(names) or ["."], values_of(arguments)
    program = digest_program() if cached else ""
    cache = f"{cache_folder(os.environ)}/{name_cache([*map(os.path.abspath, places), *names], chosen, values)}"

    def check() -> CheckReport:
        recall = load_recall(cache, program) if cached else None
        with show_progress("finding launch files") as progress:
            world = make_world(places, add_own_package(os.environ))
            report = check_paths(places, world, chosen, values, progress, recall)
        if recall is not None:
            store_recall(recall, cache, program)
        return report

    report = check()
    if fix:
        from ur.check.catalogue import load_rules
        from ur.check.findings.suppress import plan_repairs
        from ur.cli.output import replace_file

        repairs = plan_repairs(report.findings, load_rules())
        for repair in repairs:
            replace_file(repair.path, repair.text, "repaired")
        repaired = sum(len(repair.findings) for repair in repairs)
        click.echo(f"repaired {repaired} finding{'' if repaired == 1 else 's'} in {len(repairs)} files", err=True)
        report = check()
    _show(report, form)
    if note := describe_left_out(report.left_out):
        click.echo(note, err=True)
    return report


def _words(given: tuple[str, ...]) -> list[str]:
    return [word for text in given for word in text.replace(",", " ").split()]


def _show(report: CheckReport, form: str) -> None:
    from ur.check.render.text import render_github, render_json, render_text, shorten_paths

    report = shorten_paths(report, str(Path.cwd()))
    if form == "human":
        click.echo(render_text(report, colour=shows_colour(sys.stdout)), nl=False)
    else:
        click.echo(render_json(report) if form == "json" else render_github(report), nl=False)


def check_package(path: str, fix: bool) -> int:
    """Print what package.xml and CMakeLists.txt lack, or add it; return 1 if something is missing."""
    from ur.check.collect import collect_targets
    from ur.check.worlds import make_world
    from ur.cli.output import replace_file
    from ur.launchfile.syntax.parse import count_unread, describe_unread
    from ur.request.environment import add_own_package
    from ur.source.diagnostic import user_error
    from ur.source.progress_line import show_progress
    from ur.source.read import read_source
    from ur.tools.new.package import CMAKE
    from ur.tools.new.target import find_target
    from ur.tools.package.cmake import choose_folders, describe_changes, put_block, write_block
    from ur.tools.package.uses import add_run_dependencies, find_used_packages, read_optional, read_run_dependencies

    folder = find_target(path).folder
    with show_progress("finding launch files") as progress:
        world = make_world([str(folder)], add_own_package(os.environ))
        package, used = find_used_packages(str(folder), world, progress)
    if unread := describe_unread(count_unread(collect_targets([str(folder)], world).launch_files)):
        click.echo(f"note: {unread}", err=True)
    manifest, cmake = folder / "package.xml", folder / "CMakeLists.txt"
    texts = {manifest: read_source(manifest).text}
    texts[cmake] = read_source(cmake).text if cmake.exists() else CMAKE.format(name=package.name)
    known = read_run_dependencies(texts[manifest])
    for name in sorted(set(used) - known - read_optional(texts[manifest])):
        line, column = used[name].position
        place = f"{os.path.relpath(used[name].file.path)}:{line}:{column}"
        click.echo(f"package.xml: {name} is used at {place}, and no dependency")
    for name in sorted((known | read_optional(texts[manifest])) - set(used)):
        click.echo(f"package.xml: nothing here uses {name}; it stays", err=True)
    folders = choose_folders(each.name for each in folder.iterdir() if each.is_dir())
    files = [each.name for each in folder.iterdir() if each.name.endswith((".launch", ".launch.xml"))]
    wanted = {
        manifest: add_run_dependencies(texts[manifest], used),
        cmake: put_block(texts[cmake], write_block(folders, files)),
    }
    for change in describe_changes(texts[cmake], wanted[cmake]):
        click.echo(f"CMakeLists.txt: {change}")
    changed = [each for each in wanted if wanted[each] != texts[each] or not each.exists()]
    if not changed:
        click.echo(f"{package.name}: package.xml and CMakeLists.txt hold what it needs")
        return 0
    if not fix:
        click.echo(f"help: ur check --package --fix {os.path.relpath(folder)}", err=True)
        return 1
    for each in changed:
        if each.is_symlink() and not each.resolve().is_relative_to(folder.resolve()):
            message = f"{os.path.relpath(each)} is a link that leads out of the package, expected a file"
            raise user_error(message, rule="unwritable-file", help="put a file in its place")
        replace_file(str(each), wanted[each])
        click.echo(f"wrote {os.path.relpath(each)}")
    return 0
