"""Every launch file that Debian installs and every one of the corpus: formatted, and meaning what it meant."""

import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.launchfile.conftest import Reference, differences, our_plan, read_case

from ur.check.collect import collect_targets
from ur.check.worlds import CachedWorld, make_world
from ur.source.diagnostic import UserError
from ur.tools.format.run import format_file

LAUNCHFILE = Path(__file__).parents[2] / "launchfile"
SHIPPED = sorted(
    path
    for package in Path("/usr/share").glob("*/package.xml")
    for pattern in ("*.launch", "*.launch.xml", "*.test")
    for path in package.parent.rglob(pattern)
)


def format_all(folder: Path) -> list[Path]:
    """Format every launch file of a folder in its place; those that can be read."""
    world = CachedWorld(make_world([str(folder)], os.environ))
    targets = collect_targets([str(folder)], world)
    done = []
    for path in targets.launch_files:
        data = Path(path).read_bytes()
        try:
            formatted = format_file(path, data, world, targets.package_of(path))
        except UserError:
            continue
        again = format_file(path, formatted.text.encode(), world, targets.package_of(path))
        assert again.text == formatted.text, f"{path}: a second run changes it again"
        Path(path).write_text(formatted.text, encoding="utf-8")
        done.append(Path(path))
    return done


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Path]]:
    """A copy of the corpus, formatted."""
    folder = tmp_path_factory.mktemp("formatted") / LAUNCHFILE.name
    shutil.copytree(LAUNCHFILE, folder, symlinks=True)
    return folder, format_all(folder)


def in_folder(dumped: dict[str, Any], folder: Path) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(json.dumps(dumped).replace(str(LAUNCHFILE), str(folder)))
    return answer | ({"files": sorted(answer["files"])} if answer["ok"] else {})


def cases(corpus: tuple[Path, list[Path]]) -> Iterator[tuple[Path, Path, list[str], dict[str, str], dict[str, str]]]:
    folder, files = corpus
    for path in files:
        original = LAUNCHFILE / path.relative_to(folder)
        arguments, environment = read_case(original)
        moved = {name: value.replace(str(LAUNCHFILE), str(folder)) for name, value in environment.items()}
        yield original, path, arguments, environment, moved


def test_formatted_corpus_means_what_it_meant(corpus: tuple[Path, list[Path]]) -> None:
    found = []
    count = 0
    for original, path, arguments, environment, moved in cases(corpus):
        before = in_folder(our_plan([str(original)], arguments, environment), corpus[0])
        found += [f"{path}: {line}" for line in differences(our_plan([str(path)], arguments, moved), before)]
        count += 1
    assert not found, "\n".join(found)
    assert count > 700


def test_roslaunch_reads_the_formatted_corpus_alike(corpus: tuple[Path, list[Path]]) -> None:
    if not Path("/usr/lib/python3/dist-packages/roslaunch").exists():
        pytest.skip("python3-roslaunch is not installed")
    reference = Reference()
    try:
        found = []
        for original, path, arguments, environment, moved in cases(corpus):
            before = in_folder(reference.load([str(original)], arguments, environment), corpus[0])
            after = reference.load([str(path)], arguments, moved)
            found += [f"{path}: {line}" for line in differences(after, before)]
        assert not found, "\n".join(found)
    finally:
        reference.close()


def test_installed_launch_files_mean_what_they_meant_and_a_second_run_changes_nothing() -> None:
    if not SHIPPED:
        pytest.skip("no package with launch files is installed")
    world = CachedWorld(make_world(["/usr/share/roslaunch"], os.environ))
    for path in SHIPPED:
        data = path.read_bytes()
        formatted = format_file(str(path), data, world)  # compares the plans
        assert formatted.kept is None or "layout" in formatted.kept
        assert format_file(str(path), formatted.text.encode(), world).text == formatted.text
