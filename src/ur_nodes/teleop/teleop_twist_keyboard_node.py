"""Drive with the keys: the stand-in for teleop_twist_keyboard."""

from __future__ import annotations

import os
import select
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import rospy
from geometry_msgs.msg import Twist, TwistStamped, Vector3

from ur_nodes.rosio.parameters import Parameters
from ur_nodes.teleop.drive import STILL, DriveSettings, Motion, start_drive, step_drive, wish_of
from ur_nodes.teleop.drive_screen import Link, draw_drive_screen
from ur_nodes.teleop.emergency import Emergency
from ur_nodes.teleop.foreground_node import run_in_foreground
from ur_nodes.teleop.keys import Key, decode_keys
from ur_nodes.teleop.mux_link_node import MuxLink
from ur_nodes.teleop.terminal import Terminal, own_terminal

_NAME = "teleop_twist_keyboard"
_PIPE_HOLD = 0.5  # s: how long each key of a pipe drives
_ESCAPE_WAIT = 0.05  # s: a sequence's bytes come together; ESC that stays alone is the key
_ALIVE_EVERY = 0.25  # s
_LISTENER_WAIT = 5.0  # s: a pipe's first key waits this long for a listener

Publish = Callable[[Motion], None]


def main() -> int:
    """Run until Ctrl-C, the end of the pipe, or shutdown. Returns the exit code."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    settings, rate = _read_settings(Parameters())
    mux_name = Parameters().text("mux", "cmd_vel_mux")
    publisher, publish = _make_publisher(Parameters())
    try:
        if sys.stdin.isatty() and sys.stdout.isatty():
            mux = MuxLink(mux_name)
            with own_terminal(sys.stdin.fileno(), sys.stdout.fileno()) as terminal:
                drive_terminal(terminal, settings, rate, publish, lambda: _link(publisher), mux, ended)
            return 0
        _wait_for_listener(publisher, ended)
        return drive_pipe(sys.stdin.fileno(), settings, rate, publish, ended)
    finally:
        if not rospy.is_shutdown():
            publish(STILL)


def drive_terminal(
    terminal: Terminal,
    settings: DriveSettings,
    rate: float,
    publish: Publish,
    link: Callable[[], Link],
    mux: Emergency,
    ended: threading.Event,
) -> None:
    """Drive by the keys of a terminal until it ends, Ctrl-C is pressed or `ended` is set."""
    state, rest, drawn_at = start_drive(settings), b"", -1.0
    asked_at, next_step = 0.0, time.monotonic()
    while not (ended.is_set() or state.quit):
        data = terminal.read(min(next_step - time.monotonic(), _ESCAPE_WAIT if rest else 1.0))
        if data is None:
            return
        events, rest = decode_keys(rest + data, final=not data)
        now = time.monotonic()
        for event in events:
            if (wish := wish_of(event)) is not None:
                mux.ask(wish)
            was_moving = state.moving
            state, motion = step_drive(state, event, now)
            if motion is not None and state.moving != was_moving:
                publish(motion)  # starts and stops are not kept waiting
        due = now >= next_step
        if due:
            state, motion = step_drive(state, None, now)
            if motion is not None:
                publish(motion)
        later = now + (1.0 / rate if state.moving or state.zeros_left else 0.2)
        next_step = later if due else min(next_step, later)  # keys that repeat faster than that must not put it off
        if state.moving and state.reports_release and now - asked_at > _ALIVE_EVERY:
            asked_at = now
            terminal.ask_for_life()
        again = now - drawn_at > 2.0  # other programs may have written on the screen
        drawn_at = now if again else drawn_at
        terminal.show(draw_drive_screen(state, link(), mux.view(), *terminal.size()), again=again)


def drive_pipe(source: int, settings: DriveSettings, rate: float, publish: Publish, ended: threading.Event) -> int:
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
            while motion is not None and state.moving and not ended.wait(1.0 / rate):
                publish(motion)
                state, motion = step_drive(state, None, time.monotonic())
        if not data:
            break
    for _ in range(3):
        publish(STILL)
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
    return settings, max(rate, 10.0) if rate else 30.0  # commands that are older than 0.15 s count no more


def _make_publisher(parameters: Parameters) -> tuple[Any, Publish]:
    stamped = parameters.boolean("stamped", False)
    frame = parameters.text("frame_id", "")
    publisher = rospy.Publisher("cmd_vel", TwistStamped if stamped else Twist, queue_size=1)

    def publish(motion: Motion) -> None:
        twist = Twist(Vector3(motion.x, motion.y, motion.z), Vector3(0.0, 0.0, motion.yaw))
        if not stamped:
            publisher.publish(twist)
            return
        message = TwistStamped(twist=twist)
        message.header.stamp, message.header.frame_id = rospy.Time.now(), frame
        publisher.publish(message)

    return publisher, publish


def _link(publisher: Any) -> Link:
    return Link(publisher.resolved_name, publisher.get_num_connections())


def _wait_for_listener(publisher: Any, ended: threading.Event) -> None:
    deadline = time.monotonic() + _LISTENER_WAIT
    while not publisher.get_num_connections():
        if time.monotonic() > deadline:
            sys.stderr.write(
                f"warning: {_NAME}: nobody listens to {publisher.resolved_name} after {_LISTENER_WAIT:g} s, "
                "expected a robot; driving anyway\n"
            )
            return
        if ended.wait(0.05):
            return


if __name__ == "__main__":
    sys.exit(main())
