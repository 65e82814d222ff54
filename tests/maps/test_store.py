from pathlib import Path

import numpy as np
import pytest

from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore, own_store
from ur.source.diagnostic import UserError


@pytest.fixture
def store(tmp_path: Path) -> MapStore:
    made = own_store({"XDG_DATA_HOME": str(tmp_path)})
    for name in ("flat", "attic"):
        write_picture(made.folder / name / "map", np.zeros((2, 2), np.int8), 0.05, (0.0, 0.0, 0.0))
    return made


def test_maps_are_listed_and_other_folders_are_not(store: MapStore) -> None:
    (store.folder / "empty").mkdir()
    (store.folder / ".new-1").mkdir()
    assert store.names() == ["attic", "flat"]
    assert MapStore(store.folder / "nothing").names() == []


def test_unknown_map_is_an_error_with_a_suggestion(store: MapStore) -> None:
    with pytest.raises(UserError) as found:
        store.resolve("flta")
    assert found.value.diagnostics[0].help == "did you mean 'flat'?"


def test_latest_follows_the_map_that_it_stands_for(store: MapStore) -> None:
    with pytest.raises(UserError, match="no map was made with this robot"):
        store.resolve("latest")
    store.set_latest("attic")
    store.set_latest("flat")
    assert store.resolve("latest") == "flat"
    store.rename("flat", "home")
    assert (store.latest(), store.names()) == ("home", ["attic", "home"])
    store.delete("home")
    assert (store.latest(), store.names()) == (None, ["attic"])


def test_rename_does_not_replace_a_map(store: MapStore) -> None:
    with pytest.raises(UserError, match="map 'attic' exists"):
        store.rename("flat", "attic")
    assert store.names() == ["attic", "flat"]


def test_map_that_is_in_use_is_neither_renamed_nor_deleted(store: MapStore) -> None:
    with store.claim("flat"):
        with pytest.raises(UserError, match="map 'flat' is in use"):
            store.delete("flat")
        with pytest.raises(UserError, match="map 'flat' is in use"):
            store.rename("flat", "home")
    assert store.names() == ["attic", "flat"]


def test_arrival_that_fails_leaves_nothing(store: MapStore) -> None:
    def arrive() -> None:
        with store.arriving("new") as folder:
            (folder / "map.yaml").touch()
            raise OSError("cut")

    with pytest.raises(OSError, match="cut"):
        arrive()
    assert sorted(each.name for each in store.folder.iterdir()) == ["attic", "flat"]
    with pytest.raises(UserError, match="map 'flat' exists"), store.arriving("flat"):
        pass


def test_deletion_removes_what_an_interrupted_one_has_left(store: MapStore) -> None:
    (store.folder / ".deleted-1").mkdir()
    store.delete("flat")
    assert [each.name for each in store.folder.iterdir()] == ["attic"]
