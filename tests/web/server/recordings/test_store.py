"""Names, list and lock of recordings."""

from pathlib import Path

import pytest

from ur.web.server.recordings.store import RecordingBusyError, Store, recordings_folder

NAME = "recording_2026-03-01_14-05-31_001.mcap"
OTHER = NAME.replace("001", "002")


@pytest.fixture
def store(tmp_path: Path) -> Store:
    made = Store(tmp_path / "recordings")
    made.prepare()
    return made


def test_folder_is_that_of_the_user_and_private(store: Store) -> None:
    environment = {"HOME": "/home/bob"}
    assert recordings_folder(environment) == Path("/home/bob/.local/state/ubiquity_launches/web/recordings")
    store.folder.chmod(0o755)
    store.prepare()
    assert store.folder.stat().st_mode & 0o777 == 0o700


def test_list_has_files_of_ours_only_the_newest_first(store: Store, tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("secret")
    for name in (NAME, OTHER, "recording_2026-03-02_00-00-00_001.mcap.part", "x.mcap", "lock", "recording_a_001.mcap"):
        (store.folder / name).write_bytes(b"12345")
    (store.folder / "recording_2026-03-03_00-00-00_001.mcap").symlink_to(secret)
    (store.folder / "recording_2026-03-04_00-00-00_001.mcap").mkdir()
    (store.folder / "recording_2026-99-99_00-00-00_001.mcap").write_bytes(b"")
    assert [(each.name, each.size, each.part, each.cut) for each in store.list()] == [
        (OTHER, 5, 2, False),
        (NAME, 5, 1, False),
    ]
    assert store.measure([NAME, OTHER, "x.mcap", "recording_a_001.mcap"]) == 5


@pytest.mark.parametrize("name", ["../secret", "/etc/passwd", "lock", "x.mcap", f"./{NAME}", "", None, 3, [NAME], "."])
def test_only_a_name_of_the_list_is_found(store: Store, name: object) -> None:
    for each in (NAME, "x.mcap", "lock"):
        (store.folder / each).write_bytes(b"")
    (store.folder.parent / "secret").write_bytes(b"")
    assert store.find(NAME) == store.folder / NAME
    assert store.find(name) is None


def test_missing_folder_has_no_recordings(tmp_path: Path) -> None:
    store = Store(tmp_path / "none")
    assert store.list() == ()
    assert store.measure() == 0
    assert not store.folder.exists()


def test_one_records_at_a_time_and_leftovers_of_a_killed_one_are_listed_as_cut(store: Store) -> None:
    (store.folder / f"{NAME}.part").write_bytes(b"1")
    other = Store(store.folder)
    with store.lock():
        with pytest.raises(RecordingBusyError), other.lock():
            pass
        store.adopt()
    with other.lock():
        pass
    assert [(each.name, each.cut) for each in store.list()] == [(NAME.replace(".mcap", "_cut.mcap"), True)]
    assert (store.folder / "lock").stat().st_mode & 0o777 == 0o600
