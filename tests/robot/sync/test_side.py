"""One side of a sync: what it lists, and what it does and leaves alone when it puts files in their places."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from ur.robot.sync import side


@pytest.fixture
def root(tmp_path: Path) -> Path:
    folder = tmp_path / "ws" / "src"
    folder.mkdir(parents=True)
    return folder


def write(root: Path, path: str, text: str = "x", *, mode: int = 0o644) -> Path:
    target = root / path
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text)
    target.chmod(mode)
    return target


def scan(root: Path, **more: Any) -> dict[str, Any]:
    return side.scan({"root": str(root), "ignore": [], "known": {}, **more})


def apply(root: Path, *steps: list[Any]) -> dict[str, Any]:
    beside = root.parent / ".ur_sync"
    request = {"root": str(root), "arriving": str(beside / "arriving"), "kept": str(beside / "kept" / "now")}
    side.prepare(request)
    return side.apply({**request, "steps": steps})


def arrive(root: Path, path: str, text: str, *, executable: bool = False) -> list[Any]:
    arrived = write(root.parent / ".ur_sync" / "arriving", path, text)
    found = side.describe(str(arrived))
    assert found
    return [*found[:3], executable, found[4]]


def listed(root: Path, path: str) -> list[Any]:
    found: list[Any] = scan(root)["files"][path]
    return found


def test_files_links_and_empty_folders_are_listed_and_the_rest_is_not(root: Path) -> None:
    write(root, "p/run", "1", mode=0o755)
    write(root, "p/odd \n\udce4", "2")
    (root / "p/link").symlink_to("nowhere")
    (root / "p/include").mkdir()
    for made in ("p/.git/config", "p/build/x", "p/a/__pycache__/m.pyc", "p/a.pyc", "p/.venv/bin/python"):
        write(root, made)
    write(root, "p/build.md", "3")
    (root / "CMakeLists.txt").symlink_to("/usr/share/catkin/cmake/toplevel.cmake")
    os.mkfifo(root / "p/pipe")
    found = scan(root)
    assert set(found["files"]) == {"p/run", "p/odd \n\udce4", "p/link", "p/include", "p/build.md"}
    assert [found["files"]["p/run"][each] for each in (0, 1, 3)] == ["file", 1, True]
    assert found["files"]["p/link"][4] == "nowhere"
    assert found["skipped"] == {"p/pipe": "neither a file, a folder nor a link"}


def test_ignore_file_of_the_workspace_counts(root: Path) -> None:
    write(root, ".ursyncignore", "# large\n*.bag\n\ndata/\np/only_here.txt\n")
    for path in ("p/a.bag", "p/data/x", "q/data", "p/only_here.txt", "q/only_here.txt"):
        write(root, path)
    assert set(scan(root)["files"]) == {".ursyncignore", "q/data", "q/only_here.txt"}


def test_workspace_that_is_not_there_is_empty(tmp_path: Path) -> None:
    assert scan(tmp_path / "none")["files"] == {}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_unreadable_file_is_named(root: Path) -> None:
    write(root, "p/secret", mode=0)
    assert scan(root)["skipped"] == {"p/secret": "permission denied"}


def test_known_file_is_not_read_again(root: Path) -> None:
    status = write(root, "f").stat()
    known = {"f": [status.st_size, status.st_mtime_ns, "from memory"], "g": [1, 1, "old"]}
    write(root, "g")
    found = scan(root, known=known)["files"]
    assert found["f"][4] == "from memory"
    assert found["g"][4] != "old"


def test_new_and_changed_and_deleted_files_are_brought_about(root: Path) -> None:
    write(root, "p/old/f", "old")
    write(root, "p/g", "1")
    before_g, before_f = listed(root, "p/g"), listed(root, "p/old/f")
    answer = apply(
        root,
        ["q/r/new", None, arrive(root, "q/r/new", "new", executable=True), False],
        ["p/g", before_g, arrive(root, "p/g", "2"), False],
        ["p/old/f", before_f, None, False],
        ["p/empty", None, ["folder", 0, 0, False, ""], False],
        ["p/link", None, ["link", 0, 0, False, "g"], False],
    )
    assert answer["left"] == {}
    assert (root / "q/r/new").read_text() == "new"
    assert os.access(root / "q/r/new", os.X_OK)
    assert (root / "p/g").read_text() == "2"
    assert not (root / "p/old").exists()
    assert (root / "p/empty").is_dir()
    assert (root / "p/link").readlink() == Path("g")
    assert scan(root)["files"]["q/r/new"] == answer["done"]["q/r/new"]
    assert not (root.parent / ".ur_sync").exists()


def test_file_that_changed_meanwhile_stays(root: Path) -> None:
    write(root, "f", "listed")
    write(root, "gone", "listed")
    before, gone = listed(root, "f"), listed(root, "gone")
    write(root, "f", "changed since")
    write(root, "appeared", "mine")
    (root / "gone").unlink()
    answer = apply(
        root,
        ["f", before, arrive(root, "f", "new"), False],
        ["appeared", None, arrive(root, "appeared", "new"), False],
        ["gone", gone, arrive(root, "gone", "new"), False],
    )
    assert set(answer["left"]) == {"f", "appeared", "gone"}
    assert (root / "f").read_text() == "changed since"
    assert (root / "appeared").read_text() == "mine"


def test_deletion_of_a_file_that_changed_meanwhile_is_not_done(root: Path) -> None:
    write(root, "f", "listed")
    before = listed(root, "f")
    write(root, "f", "changed since")
    assert "changed" in apply(root, ["f", before, None, False])["left"]["f"]
    assert (root / "f").read_text() == "changed since"


def test_content_that_has_not_arrived_whole_replaces_nothing(root: Path) -> None:
    write(root, "f", "listed")
    before = listed(root, "f")
    wanted = arrive(root, "f", "the whole text")
    arrive(root, "f", "the who")
    assert "arrived" in apply(root, ["f", before, wanted, False])["left"]["f"]
    assert (root / "f").read_text() == "listed"


def test_replaced_file_is_kept_when_asked(root: Path) -> None:
    write(root, "p/f", "mine")
    write(root, "p/g", "mine too")
    before_f, before_g = listed(root, "p/f"), listed(root, "p/g")
    apply(root, ["p/f", before_f, arrive(root, "p/f", "yours"), True], ["p/g", before_g, None, True])
    kept = root.parent / ".ur_sync/kept/now/p"
    assert (kept / "f").read_text() == "mine"
    assert (kept / "g").read_text() == "mine too"
    assert (root / "p/f").read_text() == "yours"


def test_nothing_is_written_through_a_link_out_of_the_workspace(root: Path, tmp_path: Path) -> None:
    (tmp_path / "outside").mkdir()
    (root / "p").symlink_to(tmp_path / "outside")
    assert apply(root, ["p/f", None, arrive(root, "p/f", "x"), False])["left"] == {"p/f": "its folder is a link"}
    assert list((tmp_path / "outside").iterdir()) == []


def test_file_becomes_a_folder_and_a_folder_a_file(root: Path) -> None:
    write(root, "a", "file")
    write(root, "b/c", "below")
    before_a, before_c = listed(root, "a"), listed(root, "b/c")
    answer = apply(
        root,
        ["a", before_a, None, False],
        ["a/d", None, arrive(root, "a/d", "1"), False],
        ["b", None, arrive(root, "b", "2"), False],
        ["b/c", before_c, None, False],
    )
    assert answer["left"] == {}
    assert (root / "a/d").read_text() == "1"
    assert (root / "b").read_text() == "2"


def test_program_answers_over_its_standard_streams(root: Path) -> None:
    write(root, "f")
    request = json.dumps({"do": "scan", "root": str(root), "ignore": [], "known": {}})
    done = subprocess.run(
        [sys.executable, "-I", side.__file__], input=request, capture_output=True, text=True, check=True, timeout=60
    )
    assert set(json.loads(done.stdout)["files"]) == {"f"}
