"""The cache on disk: what is damaged, old or somebody else's counts as nothing, and its size is bounded."""

import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from ur.check.cache import store
from ur.check.cache.recall import Recall
from ur.check.cache.store import CacheBounds, load_recall, store_recall
from ur.check.render.text import render_json
from ur.check.session import check_paths
from ur.launchfile.world import MemoryWorld

FILES = {
    "/w/package.xml": "<package><name>one</name></package>",
    "/w/launch/a.launch": '<launch><node name="n" pkg="one" type="nix"/><param name="a" value="$(arg b)"/></launch>',
    "/w/launch/b.launch": '<launch><include file="$(find one)/launch/c.launch"/></launch>',
}


def check(recall: Recall | None = None) -> str:
    return render_json(check_paths(["/w"], MemoryWorld(FILES, {"one": "/w"}), recall=recall))


@pytest.fixture
def cache(tmp_path: Path) -> Path:
    path = tmp_path / "check" / "cache.json"
    recall = Recall()
    check(recall)
    store_recall(recall, str(path), "program")
    return path


def reseal(path: Path, text: str) -> None:
    digest = store._digest(text.encode())
    path.write_text(json.dumps({"format": store.FORMAT, "program": "program", "digest": digest}) + "\n" + text)


def test_findings_are_recalled_from_the_file(cache: Path) -> None:
    recall = load_recall(str(cache), "program")
    assert check(recall) == check()
    assert recall.recalled == 2
    assert cache.stat().st_mode & 0o077 == 0


def test_other_program_and_other_format_begin_anew(cache: Path) -> None:
    assert not load_recall(str(cache), "other").now.units
    other = load_recall(str(cache), "other")
    check(other)
    assert other.recalled == 0
    newer = load_recall(str(cache), "program", CacheBounds(format=store.FORMAT + 1))
    check(newer)
    assert newer.recalled == 0


def test_file_that_is_cut_off_or_damaged_anywhere_is_found_again(cache: Path) -> None:
    data = cache.read_bytes()
    expected = check()
    for place in range(0, len(data), max(1, len(data) // 40)):
        for damaged in (data[:place], data[:place] + b"\xff" + data[place + 1 :]):
            cache.write_bytes(damaged)
            recall = load_recall(str(cache), "program")
            assert check(recall) == expected
            assert recall.recalled == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"error"', '"grave"'),
        ('"error"', "7"),
        ('"message"', "null"),
        ('"units":{', '"units":{"/w/launch/a.launch":["",[99],[]],'),
        ('"units":{', '"units":[],"other":{'),
        ('"is_file"', '"__class__"'),
        ('"questions":[', '"questions":[["",["read_bytes"]],'),
        ('"questions":[', '"questions":[["","seen_from","/"],'),
        (",0,", ",1e9,"),
        (",0,", ",-1,"),
    ],
)
def test_content_of_another_shape_is_found_again(cache: Path, old: str, new: str) -> None:
    text = cache.read_text().partition("\n")[2]
    reseal(cache, text.replace(old, new))
    assert check(load_recall(str(cache), "program")) == check()


def test_text_that_is_nested_too_deep_is_found_again(cache: Path) -> None:
    reseal(cache, "[" * 200_000)
    assert check(load_recall(str(cache), "program")) == check()


def test_link_folder_and_pipe_are_not_read(cache: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.json"
    link.symlink_to(cache)
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    for path in (link, pipe, tmp_path):
        recall = load_recall(str(path), "program")
        check(recall)
        assert recall.recalled == 0


def test_folder_that_cannot_be_written_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    recall = Recall()
    check(recall)
    store_recall(recall, str(tmp_path / "file" / "check" / "cache.json"), "program")


def test_checks_side_by_side_leave_a_whole_file(cache: Path) -> None:
    def run(number: int) -> None:
        recall = load_recall(str(cache), f"program{number % 2}")
        check(recall)
        store_recall(recall, str(cache), f"program{number % 2}")

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(run, range(12)))
    recalled = []
    for program in ("program0", "program1"):
        recall = load_recall(str(cache), program)
        assert check(recall) == check()
        recalled.append(recall.recalled)
    assert sorted(recalled) == [0, 2]
    assert [path.name for path in cache.parent.iterdir()] == [cache.name]


def test_oldest_files_are_removed_when_there_are_too_many(cache: Path) -> None:
    for number in range(4):
        old = cache.with_name(f"old{number}.json")
        old.write_text("x")
        os.utime(old, (number, number))
    recall = Recall()
    check(recall)
    store_recall(recall, str(cache), "program", CacheBounds(files=3))
    assert sorted(path.name for path in cache.parent.iterdir()) == ["cache.json", "old2.json", "old3.json"]
    store_recall(recall, str(cache), "program", CacheBounds(total=cache.stat().st_size))
    assert [path.name for path in cache.parent.iterdir()] == ["cache.json"]


def test_findings_that_are_too_many_are_not_kept(cache: Path) -> None:
    before = cache.read_bytes()
    recall = Recall()
    check(recall)
    store_recall(recall, str(cache), "program", CacheBounds(bytes=2000))
    assert cache.read_bytes() == before


def test_name_depends_on_places_rules_and_arguments() -> None:
    names = {
        store.name_cache(["/w"], frozenset({"a"}), {}),
        store.name_cache(["/v"], frozenset({"a"}), {}),
        store.name_cache(["/w"], frozenset({"b"}), {}),
        store.name_cache(["/w"], frozenset({"a"}), {"x": "\udc80"}),
    }
    assert len(names) == 4
