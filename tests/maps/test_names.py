import pytest

from ur.maps.names import check_map_name, fresh_name, is_map_name
from ur.source.diagnostic import UserError


@pytest.mark.parametrize("name", ["flat", "second-floor", "map-2026-05-01", "A_1.2"])
def test_ordinary_names_are_taken(name: str) -> None:
    assert check_map_name(name) == name


@pytest.mark.parametrize("name", ["", "1", "1e3", "a b", "../a", "a/b", ".a", "-a", "a.", "a" * 65, "true", "NaN", "ä"])
def test_names_that_a_shell_a_path_or_a_number_would_change_are_refused(name: str) -> None:
    assert not is_map_name(name)
    with pytest.raises(UserError):
        check_map_name(name)


def test_name_with_blanks_is_answered_with_one_that_is_allowed() -> None:
    with pytest.raises(UserError) as caught:
        check_map_name("my flat")
    assert caught.value.diagnostics[0].help == "name it my_flat"
    with pytest.raises(UserError) as caught:
        check_map_name("../my flat")
    assert caught.value.diagnostics[0].help == "for example flat or second-floor"


def test_fresh_name_is_not_taken() -> None:
    assert fresh_name("2026-05-01", ["map-2026-05-01", "map-2026-05-01-2"]) == "map-2026-05-01-3"
