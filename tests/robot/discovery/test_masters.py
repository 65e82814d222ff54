import json
from pathlib import Path

from ur.robot.discovery.masters import MOST, choose_masters, list_masters
from ur.robot.selection import Selection


def names(records: list[str], seen: list[str], own: Selection, stored: Selection | None = None) -> list[str]:
    return [each.name for each in choose_masters(records, seen, own, stored or own)]


def test_simulated_robot_is_first_and_the_shown_one_is_there_without_a_record() -> None:
    found = choose_masters(["bob"], ["carla"], Selection("Alice", ""), Selection())
    assert [(each.name, each.master) for each in found] == [
        ("sim", "http://localhost:11311"),
        ("Alice", "http://Alice.local:11311"),
        ("bob", "http://bob.local:11311"),
        ("carla", "http://carla.local:11311"),
    ]


def test_robot_that_was_set_up_and_seen_is_listed_once() -> None:
    assert names(["bob"], ["bob", "BOB"], Selection()) == ["sim", "bob"]


def test_announced_names_that_are_no_host_names_are_left_out() -> None:
    hostile = ["--port=1", "-x", "a b", "../bob", "bob:magni", "bob.local", " bob", "sim", "SIM", "", "x" * 64, "b\nc"]
    assert names([], hostile, Selection()) == ["sim"]


def test_selected_base_is_kept_for_its_robot_only() -> None:
    stored = Selection("sim", "magni", "lidar")
    found = choose_masters(["bob"], [], Selection("bob", ""), stored)
    assert [each.selection for each in found] == ["sim:magni:lidar", "bob"]


def test_list_is_bounded_and_robots_that_were_set_up_come_before_announced_ones() -> None:
    found = names(["zoe"], [f"a{number}" for number in range(1000)], Selection())
    assert len(found) == MOST
    assert "zoe" in found


def test_list_is_read_from_the_records_and_the_memory(tmp_path: Path) -> None:
    folder = tmp_path / ".config/ubiquity_launches/robots"
    folder.mkdir(parents=True)
    (folder / "bob.yaml").write_text('name: "bob"\nuser: "ros"\nbase: "magni"\n')
    state = tmp_path / ".local/state/ubiquity_launches"
    state.mkdir(parents=True)
    (state / "seen.json").write_text(json.dumps([{"name": "carla", "address": "10.0.0.2", "time": 1.0}]))
    found = list_masters({"HOME": str(tmp_path)}, Selection(), Selection())
    assert [each.name for each in found] == ["sim", "bob", "carla"]
