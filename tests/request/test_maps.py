from pathlib import Path

import numpy as np
import pytest

from ur.maps.picture_file import write_picture
from ur.maps.store import own_store
from ur.request.plan_files import resolve_map
from ur.source.arguments import Argument
from ur.source.diagnostic import UserError

DECLARED = ("map", "map_file", "world", "simulate", "localisation")


@pytest.fixture(autouse=True)
def maps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    store = own_store({"XDG_DATA_HOME": str(tmp_path)})
    write_picture(store.folder / "flat" / "map", np.zeros((2, 2), np.int8), 0.05, (0.0, 0.0, 0.0))
    store.set_latest("flat")


def resolve(*given: Argument, real: bool = True, remote: bool = False) -> tuple[Argument, ...]:
    return resolve_map(given, DECLARED, real=real, remote=remote)


def test_real_robot_uses_its_last_map() -> None:
    assert resolve() == (Argument("map", "flat"),)
    assert resolve(remote=True) == (Argument("map", "latest"),)
    assert resolve(real=False) == ()


@pytest.mark.parametrize(
    "given",
    [Argument("map_file", "/a.yaml"), Argument("world", "maze"), Argument("simulate", "true"), Argument("map", "")],
)
def test_other_choice_of_a_map_counts(given: Argument) -> None:
    assert resolve(given) == (given,)


def test_unknown_map_is_an_error_on_this_computer_only() -> None:
    with pytest.raises(UserError, match="unknown map 'flt'"):
        resolve(Argument("map", "flt"))
    assert resolve(Argument("map", "flt"), remote=True) == (Argument("map", "flt"),)
    with pytest.raises(UserError, match=r"map name '\.\./x'"):
        resolve(Argument("map", "../x"), remote=True)


def test_latest_is_replaced_by_its_name() -> None:
    assert resolve(Argument("map", "latest"), real=False) == (Argument("map", "flat"),)


def test_files_without_these_arguments_are_left_alone() -> None:
    assert resolve_map((Argument("map", "scan_map"),), ("map",), real=True, remote=False) == (
        Argument("map", "scan_map"),
    )
