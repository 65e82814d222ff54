"""`ur check`: problems in launch files, YAML files and programs."""

from __future__ import annotations

import os

import click

from ur.cli.files.check_files import check_files


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
    if explain is not None:
        from ur.check.catalogue import find_rule, list_rules
        from ur.check.render.pages import explain_rule

        click.echo(explain_rule(find_rule(explain)) if explain else list_rules(), nl=False)
        return 0
    if package:
        if len(paths) > 1:
            raise click.UsageError("--package checks one package")

        return check_package(paths[0] if paths else ".", fix)
    return check_files(paths, _words(select), _words(ignore), form, fix=fix, strict=strict, cached=not no_cache)


def _words(given: tuple[str, ...]) -> list[str]:
    return [word for text in given for word in text.replace(",", " ").split()]


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
