"""Runs that are registered: found while they live, removed when they do not."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from ur.run.client import RunGone, connect_run
from ur.run.registry import (
    RunEntry,
    find_run,
    list_runs,
    make_run_name,
    read_birth,
    register_run,
    runs_folders,
    unregister_run,
)
from ur.source.diagnostic import UserError

UID = os.getuid()


def entry_of(pid: int, name: str = "drive") -> RunEntry:
    return RunEntry(f"{name}.{pid}", pid, read_birth(pid) or 0, name, "http://x:1", "/logs", 1.0, True, "here")


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    # Longer than a socket's address may be.
    return {"HOME": str(tmp_path / ("long" * 30)), "XDG_RUNTIME_DIR": str(tmp_path / "runtime")}


def test_run_is_private_listed_and_reached_until_it_is_unregistered(environment: dict[str, str]) -> None:
    made = register_run(entry_of(os.getpid()), environment, UID)
    assert made is not None
    entry, listener = made
    with listener:
        assert Path(entry.folder).stat().st_mode & 0o777 == 0o700
        assert list_runs(environment, UID, "here") == [entry]
        assert list_runs(environment, UID, "elsewhere") == []
        client = connect_run(entry.folder)
        other, _ = listener.accept()
        other.close()
        client.close()
    unregister_run(entry)
    assert list_runs(environment, UID, "here") == []
    with pytest.raises(RunGone):
        connect_run(entry.folder)


def test_entry_whose_process_id_now_belongs_to_another_is_removed(environment: dict[str, str]) -> None:
    made = register_run(replace(entry_of(os.getpid()), born=1), environment, UID)
    assert made is not None
    made[1].close()
    assert list_runs(environment, UID, "here") == []
    assert not Path(made[0].folder).exists()


def test_folder_that_a_killed_supervisor_left_half_made_is_removed(environment: dict[str, str]) -> None:
    half = Path(runs_folders(environment, UID)[0], "drive.4194304")  # beyond the largest process id, proc(5)
    half.mkdir(parents=True)
    assert list_runs(environment, UID, "here") == []
    assert not half.exists()


def test_folder_that_others_may_write_is_not_used(environment: dict[str, str]) -> None:
    first, second = runs_folders(environment, UID)
    Path(first).mkdir(parents=True)
    Path(first).chmod(0o777)
    made = register_run(entry_of(os.getpid()), environment, UID)
    assert made is not None
    made[1].close()
    assert made[0].folder.startswith(second)


def test_words_find_runs_by_id_title_or_beginning() -> None:
    one, two = entry_of(11, "drive"), entry_of(12, "drill")
    assert find_run([one], None) == one
    assert find_run([one, two], "drill") == two
    assert find_run([one, two], "drive.11") == one
    assert find_run([one, two], "driv") == one
    for runs, word, text in (
        ([], None, "nothing runs"),
        ([one, two], None, "several runs"),
        ([one, two], "dri", "several runs"),
        ([one, two], "drove.11", "did you mean"),
    ):
        with pytest.raises(UserError) as caught:
            find_run(runs, word)
        problem = caught.value.diagnostics[0]
        assert text in f"{problem.message} {problem.help}"


def test_run_is_named_after_its_first_file() -> None:
    assert make_run_name(["/a/m_keyboard drive.launch.xml", "/b"], 7) == ("m_keyboard drive", "m_keyboard_drive.7")
