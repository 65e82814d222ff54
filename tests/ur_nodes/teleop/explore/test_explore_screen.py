from dataclasses import replace

from ur.source.ansi import strip_styles
from ur_nodes.client.mux import MuxView
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.teleop.explore.explore_terminal import draw_explore_screen, room_for_map

BLOCKED = ("too narrow at (3.00, 4.00): 0.31 m < 0.46 m", "behind an obstacle at (1.00, 2.00)")
EXPLORING = ExploreStatus("exploring", 3, 12.4, 40.2, 17.0, 65.0, BLOCKED)
FREE = MuxView(stopped=False)


def shown(status: ExploreStatus, mux: MuxView = FREE, note: str = "", columns: int = 100, rows: int = 30) -> list[str]:
    wide, high = room_for_map(columns, rows)
    return [strip_styles(line) for line in draw_explore_screen(status, mux, note, columns, rows, ["#" * wide] * high)]


def test_progress_unreachable_frontiers_notes_and_keys_are_below_the_map() -> None:
    lines = shown(EXPLORING, note="map 'flat' saved")
    assert len(lines) == 30
    assert set(lines[:25]) == {"#" * 100}
    assert lines[25] == ("▲ exploring  40 m² known, 17 m driven in 1:05 min; 3 frontiers left, about 12 m² unknown")
    assert lines[26] == f"2 unreachable: {BLOCKED[0]}, {BLOCKED[1]}"
    assert lines[27] == "map 'flat' saved"
    assert lines[28].startswith("space: emergency stop")
    assert lines[29] == "s: save the map  n: save what happened"


def test_narrow_terminal_keeps_the_frontiers_that_are_left_in_sight() -> None:
    lines = shown(EXPLORING, columns=60)
    assert lines[25] == "▲ exploring  40 m² known, 17 m driven in 1:05 min"
    assert lines[26].startswith("3 frontiers left, about 12 m² unknown; 2 unreachable: too n")
    assert lines[27] == "? frontier  x given up"


def test_emergency_stop_comes_first_and_names_the_key_that_ends_it() -> None:
    paused = ExploreStatus("paused", 3, 12.4, 40.2, 17.0, 65.0, reason="the emergency stop is pressed")
    assert shown(paused, MuxView(stopped=True))[25].strip() == "EMERGENCY STOP: r lets the robot drive again"
    assert shown(paused)[25] == "■ paused: the emergency stop is pressed"
    assert shown(ExploreStatus(reason="no map on /map; is a mapping node running?"))[25].startswith(
        "waiting: no map on /map"
    )


def test_small_terminal_shows_text_without_a_map() -> None:
    assert room_for_map(29, 40) == (0, 0)
    assert room_for_map(80, 11) == (0, 0)
    lines = shown(EXPLORING, columns=60, rows=8)
    assert not any("#" in line for line in lines)
    assert len(lines) <= 8
    assert "too narrow" in " ".join(lines)
    assert all(len(line) <= 60 for line in lines)


def test_time_left_stands_beside_what_is_left() -> None:
    lines = shown(replace(EXPLORING, left=250.0), columns=110)
    assert lines[25].endswith("3 frontiers left, about 12 m² unknown, about 4 min left")
