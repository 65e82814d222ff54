"""Whose change is it: a table of single paths, and properties of whole workspaces."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.sync.compare import BOTH, CLASH, DELETED, FIRST, agree, compare, drop_ignored
from ur.robot.sync.steps import Agreed, File, Manifest, Side, SyncPlan, SyncStep

Tree = dict[str, File]
Case = tuple[str, str, str, str]


def file(content: str, *, kind: Literal["file", "link", "folder"] = "file", executable: bool = False) -> File:
    return File(kind, len(content), 1, executable, content)


def manifest(tree: Mapping[str, File]) -> Manifest:
    return Manifest(tree)


def agreed(tree: Mapping[str, File]) -> dict[str, Agreed]:
    return {path: Agreed(each, each) for path, each in tree.items()}


# What is here, there, and was at the last sync ('': nothing); and what becomes of it.
TABLE: tuple[Case, ...] = (
    ("a", "a", "a", "same"),
    ("a", "a", "", "same"),
    ("b", "b", "a", "same"),
    ("", "", "a", "same"),
    ("a", "", "", "there"),
    ("", "a", "", "here"),
    ("b", "a", "a", "there"),
    ("a", "b", "a", "here"),
    ("", "a", "a", "delete there"),
    ("a", "", "a", "delete here"),
    ("a", "b", "", FIRST),
    ("b", "c", "a", BOTH),
    ("b", "", "a", DELETED),
    ("", "b", "a", DELETED),
)


def tree(text: str) -> Tree:
    return {"p/f": file(text)} if text else {}


@pytest.mark.parametrize(("here", "there", "last", "expected"), TABLE)
def test_path_follows_the_side_that_changed_it(here: str, there: str, last: str, expected: str) -> None:
    # Another file keeps both sides from being empty.
    rest = {"other": file("o")}
    plan = compare(manifest(tree(here) | rest), manifest(tree(there) | rest), agreed(tree(last) | rest))
    said = [("delete " if step.after is None else "") + step.to for step in plan.steps]
    said += [each.reason for each in plan.conflicts]
    assert said == ([] if expected == "same" else [expected])
    assert plan.same["other"].identity == file("o").identity


@pytest.mark.parametrize("prefer", ["here", "there"])
def test_conflict_that_is_taken_goes_one_way_and_keeps_the_other(prefer: Side) -> None:
    plan = compare(manifest(tree("b")), manifest(tree("c")), agreed(tree("a")), prefer=prefer, only=["p"])
    (step,) = plan.steps
    assert step.to == ("there" if prefer == "here" else "here")
    assert step.keep
    assert step.after == file("b" if prefer == "here" else "c")


def test_one_direction_leaves_the_other_waiting() -> None:
    plan = compare(manifest({"a": file("1")}), manifest({"b": file("2")}), {}, to=["there"])
    assert [step.path for step in plan.steps] == ["a"]
    assert [step.path for step in plan.waiting] == ["b"]


def test_only_the_named_paths_are_compared_and_the_rest_is_remembered() -> None:
    last = agreed({"p/f": file("a"), "q/f": file("a")})
    plan = compare(
        manifest({"p/f": file("b"), "q/f": file("b")}), manifest({"p/f": file("a"), "q/f": file("a")}), last, only=["p"]
    )
    assert [step.path for step in plan.steps] == ["p/f"]
    assert plan.same["q/f"].identity == file("a").identity


@pytest.mark.parametrize("gone", ["here", "there"])
def test_workspace_that_is_empty_all_of_a_sudden_deletes_nothing(gone: Side) -> None:
    full = {"p/f": file("a"), "p/g": file("a")}
    sides = {"here": full, "there": full, gone: {}}
    plan = compare(manifest(sides["here"]), manifest(sides["there"]), agreed(full))
    assert [(step.to, step.after) for step in plan.steps] == [(gone, file("a"))] * 2
    assert gone in plan.notes[0]


def test_what_cannot_be_read_is_neither_deleted_nor_forgotten() -> None:
    last = agreed({"p/secret/f": file("a"), "o": file("o")})
    plan = compare(
        Manifest({"o": file("o")}, {"p/secret": "permission denied"}),
        manifest({"p/secret/f": file("a"), "o": file("o")}),
        last,
    )
    assert plan.steps == ()
    assert "p/secret/f" in plan.same
    assert plan.skipped == {"p/secret": "here: permission denied"}


def test_file_and_folder_of_one_name_are_a_conflict() -> None:
    plan = compare(manifest({"a": file("1")}), manifest({"a/b": file("2")}), {})
    assert plan.steps == ()
    assert {each.path: each.reason for each in plan.conflicts} == {"a": CLASH, "a/b": CLASH}


def test_file_that_became_a_folder_is_carried() -> None:
    plan = compare(manifest({"a/b": file("2")}), manifest({"a": file("1")}), agreed({"a": file("1")}))
    assert plan.conflicts == ()
    assert [(step.path, step.after) for step in plan.steps] == [("a", None), ("a/b", file("2"))]


def test_what_one_side_ignores_is_left_out_on_both() -> None:
    side = Manifest({"p/data/big.bag": file("1"), "p/f.py": file("2")}, {"p/data/x": "why"})
    left = drop_ignored(side, ["data/"])
    assert (list(left.files), dict(left.skipped)) == (["p/f.py"], {})


paths = st.sampled_from(["a", "b", "p/a", "p/b", "p/q/a", "p/q", "p"])
files = st.builds(
    lambda content, kind, executable: file(
        "" if kind == "folder" else content, kind=kind, executable=executable and kind == "file"
    ),
    st.sampled_from("123"),
    st.sampled_from(["file", "file", "file", "link", "folder"]),
    st.booleans(),
)


def make_tree(found: Tree) -> Tree:
    """A tree that can be: no file with something below it, no empty folder that is not empty."""
    return {path: each for path, each in found.items() if not any(other.startswith(f"{path}/") for other in found)}


trees = st.dictionaries(paths, files, max_size=5).map(make_tree)
plans = st.tuples(trees, trees, trees)


def apply_states(here: Tree, there: Tree, plan: SyncPlan, count: int | None = None) -> dict[Side, Tree]:
    """Both sides after the first `count` steps, with what a file system does to folders."""
    sides: dict[Side, Tree] = {"here": dict(here), "there": dict(there)}
    for step in sorted(plan.steps, key=lambda each: each.after is not None)[:count]:
        side = sides[step.to]
        assert side.get(step.path) == step.before
        if step.after is None:
            del side[step.path]
        else:
            side[step.path] = step.after
    return {name: drop_full_folders(side) for name, side in sides.items()}


def drop_full_folders(side: Tree) -> Tree:
    full = [p for p, each in side.items() if each.kind == "folder" and any(q.startswith(f"{p}/") for q in side)]
    return {path: each for path, each in side.items() if path not in full}


def remember(plan: SyncPlan) -> dict[str, Agreed]:
    done: dict[Side, dict[str, File | None]] = {"here": {}, "there": {}}
    for step in plan.steps:
        done[step.to][step.path] = step.after
    return agree(plan, done)


@given(plans)
def test_no_change_of_either_side_is_lost(case: tuple[Tree, Tree, Tree]) -> None:
    here, there, last = case
    plan = compare(manifest(here), manifest(there), agreed(last))
    after = apply_states(here, there, plan)
    for side in (here, there):
        for path, each in side.items():
            changed = path not in last or last[path].identity != each.identity
            if changed and each.kind != "folder":
                assert each in (after["here"].get(path), after["there"].get(path))


@given(plans)
def test_only_what_was_not_changed_since_is_deleted_or_replaced(case: tuple[Tree, Tree, Tree]) -> None:
    here, there, last = case
    plan = compare(manifest(here), manifest(there), agreed(last))
    for step in plan.steps:
        assert step.before is None or step.before.identity == last[step.path].identity
        assert not step.keep


@given(plans)
def test_both_sides_are_alike_afterwards_but_for_conflicts(case: tuple[Tree, Tree, Tree]) -> None:
    here, there, last = case
    plan = compare(manifest(here), manifest(there), agreed(last))
    after = apply_states(here, there, plan)
    open_paths = {each.path for each in plan.conflicts}
    for path in {*after["here"], *after["there"]} - open_paths:
        mine, yours = after["here"].get(path), after["there"].get(path)
        if (mine or yours) != file("", kind="folder"):  # whether a folder is empty depends on conflicts in it
            assert mine == yours


@given(plans)
def test_trees_stay_trees(case: tuple[Tree, Tree, Tree]) -> None:
    here, there, last = case
    for side in apply_states(here, there, compare(manifest(here), manifest(there), agreed(last))).values():
        assert make_tree(side) == side


@given(plans)
def test_second_sync_finds_nothing_new(case: tuple[Tree, Tree, Tree]) -> None:
    here, there, last = case
    plan = compare(manifest(here), manifest(there), agreed(last))
    after = apply_states(here, there, plan)
    again = compare(manifest(after["here"]), manifest(after["there"]), remember(plan))
    if not again.notes:  # one side may have become empty
        assert [step for step in again.steps if (step.before or step.after) != file("", kind="folder")] == []
    assert {each.path for each in again.conflicts} <= {each.path for each in plan.conflicts}


@given(plans, st.integers(0, 8))
def test_interrupted_sync_is_finished_by_the_next(case: tuple[Tree, Tree, Tree], count: int) -> None:
    here, there, last = case
    plan = compare(manifest(here), manifest(there), agreed(last))
    whole = apply_states(here, there, plan)
    part = apply_states(here, there, plan, count)  # and nothing of it was remembered
    rest = compare(manifest(part["here"]), manifest(part["there"]), agreed(last))
    after = apply_states(part["here"], part["there"], rest)
    if not plan.notes and not rest.notes:
        assert without_folders(after) == without_folders(whole)


def without_folders(sides: Mapping[Side, Tree]) -> dict[Side, Tree]:
    return {name: {p: each for p, each in side.items() if each.kind != "folder"} for name, side in sides.items()}


@given(plans)
def test_both_sides_count_alike(case: tuple[Tree, Tree, Tree]) -> None:
    here, there, last = case
    plan = compare(manifest(here), manifest(there), agreed(last))
    mirrored = compare(manifest(there), manifest(here), agreed(last))
    other: dict[Side, Side] = {"here": "there", "there": "here"}
    turned = {replace(step, to=other[step.to]) for step in mirrored.steps}
    assert turned == set[SyncStep](plan.steps)
    assert [each.path for each in mirrored.conflicts] == [each.path for each in plan.conflicts]
