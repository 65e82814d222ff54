"""`ur check --package`: package.xml and CMakeLists.txt, compared with the packages that launch files use."""

from __future__ import annotations

import os

import click


def check_package(path: str, fix: bool) -> int:
    """Print what package.xml and CMakeLists.txt lack, or add it; return 1 if something is missing."""
    from ur.check.collect import collect_targets
    from ur.check.computer import make_world
    from ur.cli.output import replace_file
    from ur.launchfile.syntax.ros2 import describe_unread
    from ur.request.environment import add_own_package
    from ur.source.diagnostic import UserError, error
    from ur.source.progress_line import show_progress
    from ur.source.read import read_source
    from ur.tools.new.target import find_target
    from ur.tools.package.cmake import choose_folders, describe_changes, put_block, write_block
    from ur.tools.package.uses import add_run_dependencies, find_used_packages, read_optional, read_run_dependencies

    folder = find_target(path).folder
    with show_progress("finding launch files") as progress:
        world = make_world([str(folder)], add_own_package(os.environ))
        package, used = find_used_packages(str(folder), world, progress)
    if unread := describe_unread(collect_targets([str(folder)], world).not_read):
        click.echo(f"note: {unread}", err=True)
    manifest, cmake = folder / "package.xml", folder / "CMakeLists.txt"
    texts = {manifest: read_source(manifest).text}
    texts[cmake] = read_source(cmake).text if cmake.exists() else _start_of_cmake(package.name)
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
            raise UserError(error(message, rule="unwritable-file", help="put a file in its place"))
        replace_file(str(each), wanted[each])
        click.echo(f"wrote {os.path.relpath(each)}")
    return 0


def _start_of_cmake(name: str) -> str:
    return (
        f"cmake_minimum_required(VERSION 3.10)\nproject({name} NONE)\nfind_package(catkin REQUIRED)\ncatkin_package()\n"
    )
