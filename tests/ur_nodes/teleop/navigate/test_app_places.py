"""Waypoints, patrols and the saving of the map on the navigation screen."""

from typing import Any

from tests.ur_nodes.teleop.navigate.app_screen import AppScreen
from tests.ur_nodes.teleop.recordings import SAVED, no_recordings, serve_recordings
from textual.widgets import Static

from ur_nodes.client.saving import MapSaving, save_recordings
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.teleop.navigate.app import NavigateApp


async def test_waypoint_is_remembered_listed_and_driven_to(screen: AppScreen, navigator: Any) -> None:
    navigator.move(Pose2(1.0, 2.0, 0.0))
    await screen.type("w kitchen")
    assert "waypoint 'kitchen' saved at 1.00 2.00 0" in screen.text("message")
    await screen.type("l")
    assert screen.panel.is_open
    assert "kitchen  1.00 2.00 0" in screen.panel_text()
    await screen.pilot.press("x")
    await screen.type("m kitchen")
    assert navigator.goals == [Pose2(1.0, 2.0, 0.0)]


async def test_broken_waypoint_file_is_named(navigator: Any, store: WaypointStore) -> None:
    store.path.parent.mkdir(parents=True)
    store.path.write_text("a: [1, 2]\n")
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings())
    async with app.run_test(size=(160, 30)) as pilot:
        await pilot.pause()
        assert "expected a list of 3 numbers" in str(app.query_one("#message", Static).render())


async def test_map_that_is_made_is_saved_and_has_no_waypoints_before_it_has_a_name(navigator: Any) -> None:
    bus = Bus()
    bus.node("slam").serve("save", Trigger, lambda _: Result(True, "flat"))
    saving = MapSaving(bus.node("keyboard_navigate"), "save", hint="save: save the map")
    serve_recordings(bus)
    recording = save_recordings(bus.node("client"))
    app = NavigateApp(navigator, lambda _: None, recording=recording, saving=saving)
    async with app.run_test(size=(100, 36)) as pilot:
        screen = AppScreen(app, pilot)
        await screen.refresh()
        bus.run(0.1)
        await screen.type("w here")
        assert "the map has no name yet" in screen.text("message")
        await screen.type("save")
        bus.run(0.1)
        await screen.refresh()
        assert screen.text("message") == "map 'flat' saved"
        await screen.type("n")
        bus.run(0.1)
        await screen.refresh()
        assert screen.text("message") == SAVED


async def test_nothing_is_saved_where_no_map_is_made(screen: AppScreen) -> None:
    await screen.type("save")
    assert "no map is being made" in screen.text("message")


async def test_patrol_is_started_by_a_command_and_shown_whoever_has_started_it(
    screen: AppScreen, navigator: Any, store: WaypointStore
) -> None:
    store.remember("sofa", Pose2(1.0, 2.0, 0.0))
    await screen.type("patrol sofa")
    await screen.refresh()
    assert [action for action, _ in navigator.patrols] == ["start"]
    assert screen.text("message") == "patrol: drives to sofa (1 of 1)"
    assert screen.text("driver") == "patrol: drives to sofa (1 of 1); patrol pause, patrol end"
    navigator.patrol_problem = "laptop drives since 14:02"
    await screen.type("patrol resume")
    await screen.refresh()
    assert screen.text("message") == "refused: laptop drives since 14:02"
