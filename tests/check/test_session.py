"""A check that is kept up to date has the findings of one that finds everything again, whatever was edited."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.check.cache.test_recall import EDITS, FILES, Workspace

from ur.check.render.text import render_json
from ur.check.session import CheckSession, finish_report


def findings_now(session: CheckSession) -> str:
    return render_json(finish_report(session))


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(EDITS, st.integers(0, 6)), min_size=1, max_size=5))
def test_session_has_the_findings_of_a_new_check_after_any_edit(
    edits: list[tuple[tuple[str, str, object], int]],
) -> None:
    workspace = Workspace()
    session = CheckSession(["/w"], workspace.world())
    findings_now(session)
    for edit, steps in edits:
        workspace.edit(*edit)
        session.renew(workspace.world())
        for _ in zip(range(steps), session.steps(), strict=False):
            pass  # an edit may come while the one before is still looked at
    assert findings_now(session) == workspace.check()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(EDITS, st.integers(0, 6)), min_size=1, max_size=5))
def test_change_of_a_text_is_taken_in_or_refused(edits: list[tuple[tuple[str, str, object], int]]) -> None:
    workspace = Workspace()
    world = workspace.world()
    session = CheckSession(["/w"], world)
    findings_now(session)
    for edit, steps in edits:
        workspace.edit(*edit)
        is_text = edit[0] in ("write", "replace", "remove")
        if is_text:
            world.become(workspace.world())
        if not is_text or not session.change(edit[1]):
            world = workspace.world()
            session.renew(world)
        for _ in zip(range(steps), session.steps(), strict=False):
            pass
    assert findings_now(session) == workspace.check()


def test_only_what_depends_on_a_file_is_checked_again() -> None:
    workspace = Workspace()
    world = workspace.world()
    session = CheckSession(["/w"], world)
    findings_now(session)
    workspace.edit("replace", "/w/two/launch/beside.launch", ("unused", "used"))
    world.become(workspace.world())
    assert session.change("/w/two/launch/beside.launch")
    touched = frozenset().union(*session.steps())
    assert {path for path in touched if path.endswith(".launch")} == {
        "/w/two/launch/beside.launch",
        "/w/two/launch/task.launch",  # includes it
    }


def test_text_that_is_the_same_changes_nothing() -> None:
    session = CheckSession(["/w"], Workspace().world())
    findings_now(session)
    assert session.change("/w/two/launch/beside.launch")
    assert not any(session.steps())


@pytest.mark.parametrize("path", ["/w/two/launch/new.launch", "/w/two/package.xml", "/w/one/bin/new"])
def test_new_files_and_those_that_describe_packages_need_a_new_reading(path: str) -> None:
    workspace = Workspace()
    world = workspace.world()
    session = CheckSession(["/w"], world)
    findings_now(session)
    workspace.edit("write", path, FILES.get(path, "") + " ")
    world.become(workspace.world())
    assert not session.change(path)
