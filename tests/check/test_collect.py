"""Which files a check looks at."""

import os
from pathlib import Path

import pytest

from ur.check.collect import collect_targets
from ur.check.rule import describe_left_out
from ur.check.worlds import make_world
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


def test_package_is_found_by_name_and_follows_conventions() -> None:
    targets = collect_targets(["alpha"], WORLD)
    package = targets.package_of("/s/a/launch/one.launch")
    assert package is not None
    assert (package.name, package.follows_conventions, package.depends) == ("alpha", True, frozenset({"beta"}))
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
    with pytest.raises(UserError, match="not a launch file"):
        collect_targets([path], WORLD)


def test_links_that_go_round_end(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    (folder / "launch").mkdir(parents=True)
    (folder / "launch" / "a.launch").write_text(LAUNCH)
    for name in ("one", "two"):
        (folder / name).symlink_to(folder)
    targets = collect_targets([str(folder)], make_world([str(folder)], {}))
    assert targets.launch_files == (f"{folder}/launch/a.launch",)


@pytest.mark.parametrize(
    ("word", "said", "help_"),
    [
        ("empty", "empty: the folder is empty", "'ur new package' makes a package"),
        ("pipe", "pipe: neither a regular file nor a folder", "ls -l pipe"),
        ("emty", "emty: no such file, folder or package", "did you mean empty?"),
        ("ubiquity_launche", "no such file, folder or package", "did you mean ubiquity_launches?"),
        ("x" * 300, "no such file, folder or package", "lists the files beside it"),
    ],
)
def test_word_that_names_nothing_to_check_is_explained(
    word: str, said: str, help_: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("empty").mkdir()
    os.mkfifo("pipe")
    environment = {"ROS_PACKAGE_PATH": str(Path(__file__).parents[2] / "ubiquity_launches")}
    with pytest.raises(UserError) as caught:
        collect_targets([word], make_world([word], environment))
    (found,) = caught.value.diagnostics
    assert said in found.message
    assert help_ in (found.help or "")


def _may_not_read(folder: Path) -> bool:
    folder.chmod(0)
    return not os.access(folder, os.R_OK)


def test_folders_that_cannot_be_read_are_reported_and_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "one.launch").write_text(LAUNCH)
    secret = tmp_path / "secret"
    secret.mkdir()
    monkeypatch.chdir(tmp_path)
    if not _may_not_read(secret):  # root may read everything
        monkeypatch.setattr(os, "access", lambda path, _mode: Path(path) != secret)
    try:
        targets = collect_targets(["."], make_world(["."], {}))
        assert names(targets.launch_files) == [str(tmp_path / "one.launch")]
        assert describe_left_out(targets.left_out) == "note: 1 folder cannot be read and is left out: secret"
        with pytest.raises(UserError, match="secret: the folder cannot be read"):
            collect_targets(["secret"], make_world(["secret"], {}))
    finally:
        secret.chmod(0o700)
