"""A record of what was obeyed and how the base moved, and a plain WebSocket-to-cmd_vel bridge as the peer."""

from __future__ import annotations

import asyncio
import json
import math
import threading
import time

import rospy
from aiohttp import web
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry


class Record:
    """Commands for motion that were passed on to the mux or the base, and the speed of the base, with their times."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._commands: list[tuple[float, float]] = []
        self._speeds: list[tuple[float, float]] = []
        rospy.Subscriber("web_vel_stamped", TwistStamped, lambda message: self.note(message.twist.linear.x))
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._on_truth, tcp_nodelay=True)

    def note(self, forward: float) -> None:
        """Note a command that is passed on."""
        if forward:
            with self._lock:
                self._commands.append((time.monotonic(), forward))

    def begin(self) -> None:
        """Forget what was."""
        with self._lock:
            self._commands, self._speeds = [], []

    def read(self) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
        """Return (time, forward) of the commands and (time, speed) of the base."""
        with self._lock:
            return list(self._commands), list(self._speeds)

    @property
    def speed(self) -> float:
        """The newest speed of the base, m/s."""
        with self._lock:
            return self._speeds[-1][1] if self._speeds else math.nan

    def _on_truth(self, message: Odometry) -> None:
        speed = math.hypot(message.twist.twist.linear.x, message.twist.twist.linear.y)
        with self._lock:
            self._speeds.append((time.monotonic(), speed))


class PlainBridge:
    """Publishes each velocity that a web socket carries on `cmd_vel`, at once: what rosbridge and its like do."""

    def __init__(self, record: Record) -> None:
        self._record = record
        self._publisher = rospy.Publisher("cmd_vel", Twist, queue_size=10, tcp_nodelay=True)

    async def serve(self, port: int) -> web.AppRunner:
        """Serve until the runner is cleaned up."""
        app = web.Application()
        app.add_routes([web.get("/ws/drive", self._take)])
        runner = web.AppRunner(app, access_log=None)
        await runner.setup()
        await web.TCPSite(runner, "127.0.0.1", port).start()
        return runner

    async def _take(self, request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        async for message in socket:
            if message.type is web.WSMsgType.TEXT:
                forward = json.loads(message.data).get("forward", 0.0)
                twist = Twist()
                twist.linear.x = forward
                self._record.note(forward)
                self._publisher.publish(twist)
                await asyncio.sleep(0)
        return socket
