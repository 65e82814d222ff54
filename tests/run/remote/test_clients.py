from pathlib import Path

import pytest

from ur.run.remote.own_clients import (
    MAX_CLIENTS,
    TooManyClientsError,
    add_client,
    is_shared,
    read_clients,
    remove_clients,
    remove_dead,
    write_clients,
)
from ur.run.remote.protocol import Client

ONE = Client("a1", "laptop", "m1", 7, ("/keys",), since=5.0)
TWO = Client("b2", "laptop2", "m2", 7)
DETACHED = Client("c3", "laptop", "m1", 8, detached=True)


def test_clients_are_kept_in_the_folder_of_the_run(tmp_path: Path) -> None:
    folder = str(tmp_path)
    assert not is_shared(folder)
    assert read_clients(folder) == ()
    write_clients(folder, (ONE, TWO))
    assert is_shared(folder)
    assert read_clients(folder) == (ONE, TWO)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '[{"client": "a1"}]', "[[]]"])
def test_list_that_cannot_be_read_is_empty(tmp_path: Path, text: str) -> None:
    write_clients(str(tmp_path), ())
    (path,) = tmp_path.iterdir()
    path.write_text(text)
    assert read_clients(str(tmp_path)) == ()


def test_client_is_registered_once_and_takes_detached_runs_of_its_computer_over() -> None:
    assert add_client((ONE, TWO), ONE) == (TWO, ONE)
    assert add_client((DETACHED, TWO), ONE) == (TWO, ONE)
    assert add_client((DETACHED,), TWO) == (DETACHED, TWO)


def test_number_of_clients_is_limited() -> None:
    many = tuple(Client(f"x{number}", "x", "m", 1) for number in range(MAX_CLIENTS))
    with pytest.raises(TooManyClientsError):
        add_client(many, ONE)
    assert add_client(many[1:], ONE)[-1] == ONE


def test_client_that_leaves_takes_nobody_along() -> None:
    assert remove_clients((ONE, TWO), {"a1"}) == (TWO,)
    assert remove_clients((ONE, TWO), {"unknown"}) == (ONE, TWO)


def test_clients_of_a_computer_that_it_does_not_run_any_more_are_dropped() -> None:
    assert remove_dead((ONE, TWO, DETACHED), "m1", ["other"]) == (TWO, DETACHED)
    assert remove_dead((ONE, TWO), "m1", ["a1"]) == (ONE, TWO)
