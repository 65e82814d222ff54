"""Drive with the keys: the stand-in for teleop_twist_keyboard."""

from __future__ import annotations

import os
import select
import sys
import threading
import time
from dataclasses import replace
from typing import Protocol

import rospy

from ur.source.ansi import allows_colour, is_plain
from ur_nodes.client.driver_text import (
    clock_time,
    describe_lost,
    line_of,
    may_command,
    name_holder,
)
from ur_nodes.client.mux import Emergency
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.teleop.keyboard.commander_node import (
    Commander,
    LeasedCommander,
    PlainCommander,
    make_commander,
    wait_for_listener,
)
from ur_nodes.teleop.keyboard.drive import STILL, DriveSettings, start_drive, step_drive
from ur_nodes.teleop.keyboard.drive_screen import describe_drive, draw_drive_screen, draw_map_screen, map_room
from ur_nodes.teleop.map_view.map_feed_node import MapFeed
from ur_nodes.teleop.navigator.map_saving_node import MapSaving, call_save
from ur_nodes.teleop.navigator.mux_link_node import MuxLink
from ur_nodes.teleop.terminal.foreground_node import run_in_foreground
from ur_nodes.teleop.terminal.keys import Key, KeyEvent, decode_keys
from ur_nodes.teleop.terminal.raw import Terminal, own_terminal
from ur_nodes.teleop.terminal.request_keys import asks_to_save, driver_request_of, mux_request_of, obstacle_request_of

_NAME = "teleop_twist_keyboard"
_PROGRAM = "keyboard_drive"
_PIPE_HOLD = 0.5  # s: how long each key of a pipe drives
_ESCAPE_WAIT = 0.05  # s: a sequence's bytes come together; ESC that stays alone is the key
_ALIVE_EVERY = 0.25  # s
_LISTENER_WAIT = 5.0  # s: a pipe's first key waits this long for a listener
_LEASE_WAIT = 10.0  # s: and at most this long to know who drives


class MapLines(Protocol):
    """Draws the map that grows."""

    def lines(self, columns: int, rows: int, now: float) -> list[str]:
        """The map now (s) on so many characters."""


def main() -> int:
    """Run until Ctrl-C, the end of the pipe, or shutdown. Returns the exit code."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    parameters = Parameters()
    settings, rate = _read_settings(parameters)
    mux_name = parameters.text("mux", "cmd_vel_mux")
    service = parameters.text("save_service", "")
    saving = MapSaving(lambda: call_save(service)) if service else None
    commander = make_commander(parameters, mux_name, _PROGRAM)
    try:
        if sys.stdin.isatty() and sys.stdout.isatty():
            mux = MuxLink(mux_name)
            plain, colours = is_plain(os.environ), allows_colour(os.environ)
            with own_terminal(sys.stdin.fileno(), sys.stdout.fileno(), plain=plain, colours=colours) as terminal:
                feed = None
                if parameters.boolean("show_map", False) and not plain:
                    frames = parameters.text("map_frame", "map"), parameters.text("base_frame", "base_footprint")
                    feed = MapFeed(*frames, colour=colours)
                drive_terminal(terminal, settings, rate, commander, mux, ended, saving, feed)
            return 0
        if not wait_for_listener(commander, ended, _LISTENER_WAIT) and not ended.is_set():
            sys.stderr.write(
                f"warning: {_NAME}: no subscriber on {commander.link().topic} after {_LISTENER_WAIT:g} s; "
                "is the robot running? Driving anyway\n"
            )
        if refusal := _refuse(commander):
            sys.stderr.write(f"error: {_NAME}: {refusal}\n")
            return 1
        return drive_pipe(sys.stdin.fileno(), settings, rate, commander, ended)
    finally:
        if not rospy.is_shutdown():
            commander.publish(STILL)
            commander.close()


def _refuse(commander: LeasedCommander | PlainCommander) -> str:
    """Return the reason why a pipe must not drive; empty if it may."""
    if not isinstance(commander, LeasedCommander):
        return ""
    view = commander.settle(_LEASE_WAIT)
    if view is None or may_command(view, commander.conduct):
        return ""
    if view.state == "unknown":
        return "no challenge from the mux, expected a robot that runs one (_lease:=false needs no mux)"
    if view.state == "free":
        return "UR_LEASE is watch, expected drive or take"
    if view.lost_by_other:
        return f"{describe_lost(view, 'the robot')}; expected a robot that nobody drives (UR_LEASE=take takes over)"
    since = f"{name_holder(view)} drives the robot since {clock_time(view.since)}"
    return f"{since}; expected a robot that nobody drives (UR_LEASE=take takes over)"


def drive_terminal(
    terminal: Terminal,
    settings: DriveSettings,
    rate: float,
    commander: Commander,
    mux: Emergency,
    ended: threading.Event,
    saving: MapSaving | None = None,
    growing: MapLines | None = None,
) -> None:
    """Drive by the keys of a terminal until it ends, Ctrl-C is pressed or `ended` is set.

    While a key drives, a command is sent whenever a challenge has arrived, so that it is as young as can be. With
    `saving`, one key saves the map; it stops the robot as every other key does. `growing` is shown above the rest.
    """
    state, rest, drawn_at = start_drive(settings), b"", -1.0
    asked_at, next_step = 0.0, time.monotonic()
    while not (ended.is_set() or state.quit):
        patience = min(next_step - time.monotonic(), _ESCAPE_WAIT if rest else 1.0)
        data = terminal.read(patience, commander.wake.descriptor if state.moving else None)
        if data is None:
            return
        woken = commander.wake.clear() and state.moving
        events, rest = decode_keys(rest + data, final=not data)
        now = time.monotonic()
        for event in events:
            _pass_on(event, commander, mux, saving)
            was_moving = state.moving
            state, motion = step_drive(state, event, now)
            if motion is not None and state.moving != was_moving:
                commander.publish(motion)  # starts and stops are not kept waiting
        if saving and (news := saving.take_news()):
            state = replace(state, note=news)
        due = woken or now >= next_step
        if due:
            state, motion = step_drive(state, None, now)
            if motion is not None:
                commander.publish(motion)
        later = now + (1.0 / rate if state.moving or state.zeros_left else 0.2)
        next_step = later if due else min(next_step, later)  # keys that repeat faster than that must not put it off
        if state.moving and state.reports_release and now - asked_at > _ALIVE_EVERY:
            asked_at = now
            terminal.request_answer()
        again = now - drawn_at > 2.0  # other programs may have written on the screen
        drawn_at = now if again else drawn_at
        driver = line_of(commander.view(), commander.conduct)
        if terminal.plain:
            terminal.show(describe_drive(state, commander.link(), mux.view(), driver))
            continue
        columns, rows = terminal.size()
        wide, high = map_room(columns, rows) if growing else (0, 0)
        if growing and wide:
            picture = growing.lines(wide, high, now)
            terminal.show(draw_map_screen(state, commander.link(), mux.view(), columns, picture, driver), again=again)
        else:
            terminal.show(draw_drive_screen(state, commander.link(), mux.view(), columns, rows, driver), again=again)


def _pass_on(event: KeyEvent, commander: Commander, mux: Emergency, saving: MapSaving | None) -> None:
    """Ask others for what a key means besides driving."""
    if (mux_request := mux_request_of(event)) is not None:
        mux.ask(mux_request)
    if (mux_request := obstacle_request_of(event, mux.view())) is not None:
        mux.ask(mux_request)
    if (request := driver_request_of(event)) is not None:
        commander.request(request)
    if saving and asks_to_save(event):
        saving.ask()


def drive_pipe(source: int, settings: DriveSettings, rate: float, commander: Commander, ended: threading.Event) -> int:
    """Drive by the keys of a pipe, each for half a second; line ends mean nothing. Returns the exit code."""
    state = start_drive(replace(settings, key_timeout=_PIPE_HOLD))
    rest = b""
    while not ended.is_set() and not state.quit:
        if not select.select([source], [], [], _ESCAPE_WAIT)[0]:  # a signal alone does not end a read
            continue
        data = os.read(source, 1024)
        events, rest = decode_keys(rest + data, final=not data)
        for event in events:
            if not isinstance(event, Key) or event.name == "enter":
                continue
            state, motion = step_drive(state, event, time.monotonic())
            while motion is not None and state.moving and not ended.is_set():
                commander.wake.wait(1.0 / rate)
                commander.publish(motion)
                state, motion = step_drive(state, None, time.monotonic())
        if not data:
            break
    for _ in range(3):
        commander.publish(STILL)
    ended.wait(0.1)  # let the last message leave before the connection closes
    return 0


def _read_settings(parameters: Parameters) -> tuple[DriveSettings, float]:
    speed_limit = parameters.number("speed_limit", 1000.0, minimum=0.0)
    turn_limit = parameters.number("turn_limit", 1000.0, minimum=0.0)
    settings = DriveSettings(
        speed=parameters.number("speed", min(0.5, speed_limit), minimum=0.0),
        turn=parameters.number("turn", min(1.0, turn_limit), minimum=0.0),
        speed_limit=speed_limit,
        turn_limit=turn_limit,
        key_timeout=parameters.number("key_timeout", 0.0, minimum=0.0, maximum=10.0),
    )
    rate = parameters.number("repeat_rate", 30.0, minimum=0.0, maximum=200.0)
    return settings, max(rate, 10.0) if rate else 30.0  # the mux ignores commands that are older than 0.15 s


if __name__ == "__main__":
    sys.exit(main())
