"""Runs that are registered: found while they live, removed when they do not."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from ur.cli.main import main
from ur.run.clients.client import RunUnreachable, connect_run
from ur.run.record.registry import (
    DESCRIPTION,
    Computer,
    RunEntry,
    find_run,
    list_runs,
    make_run_name,
    read_computer,
    register_run,
    runs_folders,
    unregister_run,
)
from ur.source.diagnostic import UserError
from ur.source.run_users import read_birth

UID = os.getuid()
HERE = Computer("4f1c", "boot 1", "here")
ELSEWHERE = Computer("77aa", "boot 2", "elsewhere")


def entry_of(pid: int, name: str = "drive") -> RunEntry:
    return RunEntry(
        f"{name}.{pid}",
        pid,
        read_birth(pid) or 0,
        name,
        "http://x:1",
        "/logs",
        1.0,
        True,
        "here",
        machine="4f1c",
        boot="boot 1",
    )


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
        assert list_runs(environment, UID, HERE) == [entry]
        assert list_runs(environment, UID, ELSEWHERE) == []
        client = connect_run(entry.folder)
        other, _ = listener.accept()
        other.close()
        client.close()
    unregister_run(entry)
    assert list_runs(environment, UID, HERE) == []
    with pytest.raises(RunUnreachable):
        connect_run(entry.folder)


def fall_back(monkeypatch: pytest.MonkeyPatch, shared: Path) -> dict[str, str]:
    """An environment in which runs are registered below `shared`, which is in the place of /tmp."""
    monkeypatch.setattr("ur.run.record.registry.SHARED", str(shared))
    shared.mkdir()
    shared.chmod(0o1777)
    return {"XDG_STATE_HOME": "/proc/nowhere"}


def test_run_is_registered_in_the_folder_for_everybody_where_nothing_else_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    environment = fall_back(monkeypatch, tmp_path / "tmp")
    made = register_run(entry_of(os.getpid()), environment, UID)
    assert made is not None
    made[1].close()
    assert (tmp_path / "tmp" / f"ur-{UID}").stat().st_mode & 0o777 == 0o700
    assert list_runs(environment, UID, HERE) == [made[0]]


@pytest.mark.parametrize("prepared", ["writable", "of another user", "link", "file"])
def test_folder_that_somebody_else_has_prepared_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, prepared: str
) -> None:
    environment = fall_back(monkeypatch, tmp_path / "tmp")
    above, elsewhere = tmp_path / "tmp" / f"ur-{UID}", tmp_path / "elsewhere"
    (elsewhere / "runs").mkdir(parents=True, mode=0o700)
    uid = UID
    if prepared == "link":
        above.symlink_to(elsewhere)
    elif prepared == "file":
        above.write_text("")
    else:
        above.mkdir()
        above.chmod(0o777 if prepared == "writable" else 0o755)
        uid = UID if prepared == "writable" else UID + 1
        above = above.rename(above.with_name(f"ur-{uid}"))
    before = sorted(path for path in tmp_path.rglob("*") if path.name != "runs")
    assert register_run(entry_of(os.getpid()), environment, uid) is None
    assert list_runs(environment, uid, HERE) == []
    assert sorted(path for path in tmp_path.rglob("*") if path.name != "runs") == before


def test_entry_whose_process_id_now_belongs_to_another_is_removed(environment: dict[str, str]) -> None:
    made = register_run(replace(entry_of(os.getpid()), born=1), environment, UID)
    assert made is not None
    made[1].close()
    assert list_runs(environment, UID, HERE) == []
    assert not Path(made[0].folder).exists()


@pytest.mark.parametrize(
    "damage",
    [
        {"pid": "1"},
        {"pid": True},
        {"born": 1.5},
        {"started": "yesterday"},
        {"started": float("inf")},
        {"started": float("nan")},
        {"started": -1e300},
        {"run": 7},
        {"detached": 1},
        {"host": None},
        {"master_uri": ["http://x:1"]},
        {"unknown": 1},
        "text",
        [],
        None,
    ],
    ids=repr,
)
def test_run_with_a_damaged_description_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], damage: object
) -> None:
    environment = {"HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path), "XDG_RUNTIME_DIR": str(tmp_path / "runtime")}
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    here = read_computer()
    made = []
    for name in ("drive", "damaged"):
        entry = replace(entry_of(os.getpid(), name), machine=here.machine, boot=here.boot, host=here.host)
        registered = register_run(entry, environment, UID)
        assert registered is not None
        registered[1].close()
        made.append(registered[0])
    good, bad = made
    whole = json.loads(Path(bad.folder, DESCRIPTION).read_text())
    Path(bad.folder, DESCRIPTION).write_text(json.dumps({**whole, **damage} if isinstance(damage, dict) else damage))
    assert list_runs(environment, UID, here) == [good]
    assert main(["ps"]) == 0
    shown = capsys.readouterr().out
    assert good.run in shown
    assert bad.run not in shown


def test_run_stays_listed_when_its_computer_is_renamed(environment: dict[str, str]) -> None:
    made = register_run(entry_of(os.getpid()), environment, UID)
    assert made is not None
    made[1].close()
    assert list_runs(environment, UID, replace(HERE, host="renamed")) == [made[0]]
    assert list_runs(environment, UID, replace(HERE, machine="77aa")) == []


def test_entry_of_an_earlier_boot_is_removed_though_process_and_birth_match(environment: dict[str, str]) -> None:
    made = register_run(entry_of(os.getpid()), environment, UID)
    assert made is not None
    made[1].close()
    assert list_runs(environment, UID, replace(HERE, boot="boot 2")) == []
    assert not Path(made[0].folder).exists()


def test_entry_of_an_earlier_version_is_matched_by_its_host_name(environment: dict[str, str]) -> None:
    made = register_run(replace(entry_of(os.getpid()), machine="", boot=""), environment, UID)
    assert made is not None
    made[1].close()
    description = Path(made[0].folder, DESCRIPTION)
    fields = json.loads(description.read_text())
    description.write_text(json.dumps({name: fields[name] for name in fields if name not in ("machine", "boot")}))
    assert list_runs(environment, UID, HERE) == [made[0]]
    assert list_runs(environment, UID, ELSEWHERE) == []


def test_folder_that_a_killed_supervisor_left_half_made_is_removed(environment: dict[str, str]) -> None:
    half = Path(runs_folders(environment, UID)[0], "drive.4194304")  # beyond the largest process id, proc(5)
    half.mkdir(parents=True)
    assert list_runs(environment, UID, HERE) == []
    assert not half.exists()


@pytest.mark.parametrize(
    "changes",
    [{"run": 5}, {"pid": "1"}, {"pid": True}, {"started": "now"}, {"started": None}, {"title": []}, {"detached": 1}],
)
def test_description_of_another_shape_is_no_run(environment: dict[str, str], changes: dict[str, object]) -> None:
    registered = register_run(entry_of(os.getpid()), environment, UID)
    assert registered is not None
    entry, listener = registered
    path = Path(entry.folder) / DESCRIPTION
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    assert list_runs(environment, UID, HERE) == []
    path.write_text("[" * 100_000)
    assert list_runs(environment, UID, HERE) == []
    listener.close()


def test_pipe_in_place_of_a_description_is_not_waited_for(environment: dict[str, str]) -> None:
    folder = Path(runs_folders(environment, UID)[0]) / "drive.1"
    folder.mkdir(parents=True, mode=0o700)
    os.mkfifo(folder / DESCRIPTION)
    assert list_runs(environment, UID, HERE) == []


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
        ([], None, "no run is active"),
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
