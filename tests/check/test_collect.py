"""Which files a check looks at."""

from __future__ import annotations

from pathlib import Path

import pytest

from ur.check.collect import collect_targets
from ur.check.computer import make_world
from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError

LAUNCH = "<launch></launch>"
FILES = {
    "/s/a/package.xml": "<package><name>alpha</name><exec_depend>beta</exec_depend></package>",
    "/s/a/launch/one.launch": LAUNCH,
    "/s/a/launch/two.launch.xml": LAUNCH,
    "/s/a/launch/three.xml": LAUNCH,
    "/s/a/launch/plugins.xml": "<library/>",
    "/s/a/test/four.test": LAUNCH,
    "/s/a/params/a.yaml": "",
    "/s/a/bin/ur_go": "#!/bin/bash\n",
    "/s/a/bin/go": "#!/bin/bash\n",
    "/s/a/bin/data": "no program",
    "/s/a/n_x/launch/n_x.launch": LAUNCH,
    "/s/a/bases/magni/base.yaml": "variants: {lidar: {}}",
    "/s/b/package.xml": "<package><name>beta</name></package>",
    "/s/b/launch/five.launch": LAUNCH,
    "/s/c/CATKIN_IGNORE": "",
    "/s/c/launch/six.launch": LAUNCH,
}
WORLD = MemoryWorld(FILES, {"alpha": "/s/a", "beta": "/s/b"})


def names(paths: tuple[str, ...]) -> list[str]:
    return [path.removeprefix("/s/") for path in paths]


def test_folder_gives_every_kind_of_file() -> None:
    targets = collect_targets(["/s"], WORLD)
    assert names(targets.launch_files) == [
        "a/launch/one.launch", "a/launch/three.xml", "a/launch/two.launch.xml", "a/n_x/launch/n_x.launch",
        "a/test/four.test", "b/launch/five.launch",
    ]  # fmt: skip
    assert names(targets.yaml_files) == ["a/bases/magni/base.yaml", "a/params/a.yaml"]
    assert names(targets.programs) == ["a/bin/ur_go"]
    assert [package.name for package in targets.whole] == ["alpha", "beta"]


def test_package_is_found_by_name_and_knows_its_house() -> None:
    targets = collect_targets(["alpha"], WORLD)
    package = targets.package_of("/s/a/launch/one.launch")
    assert package is not None
    assert (package.name, package.house, package.depends) == ("alpha", True, frozenset({"beta"}))
    assert [(base.name, base.variants) for base in package.bases] == [("magni", ("lidar",))]


def test_single_file_belongs_to_its_package_which_is_not_whole() -> None:
    targets = collect_targets(["/s/b/launch/five.launch"], WORLD)
    assert names(targets.launch_files) == ["b/launch/five.launch"]
    assert targets.package_of("/s/b/launch/five.launch") is not None
    assert targets.whole == ()


def test_launch_file_named_by_hand_is_taken_whatever_its_ending() -> None:
    world = MemoryWorld({"/s/odd.txt": LAUNCH})
    assert collect_targets(["/s/odd.txt"], world).launch_files == ("/s/odd.txt",)


@pytest.mark.parametrize("path", ["/s/a/launch/plugins.xml", "/s/a/package.xml", "/s/a/bin/data"])
def test_other_file_named_by_hand_is_refused(path: str) -> None:
    with pytest.raises(UserError, match="is no launch file"):
        collect_targets([path], WORLD)


def test_links_that_go_round_end(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    (folder / "launch").mkdir(parents=True)
    (folder / "launch" / "a.launch").write_text(LAUNCH)
    for name in ("one", "two"):
        (folder / name).symlink_to(folder)
    targets = collect_targets([str(folder)], make_world([str(folder)], {}))
    assert targets.launch_files == (f"{folder}/launch/a.launch",)
