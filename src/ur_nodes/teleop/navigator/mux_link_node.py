"""A mux over ROS, as people's programs see it: see `Emergency`."""

from __future__ import annotations

import threading
import time

import rospy
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger

from ur_nodes.client.mux import NO_REPORT, MuxRequest, MuxView, describe_refusal, view_of
from ur_nodes.motion.obstacle_stop.report import read_report

_PATIENCE = 1.0  # s: then the same request is sent again if a person insists


class MuxLink:
    """Asks by service, in threads of their own: a network that is gone must not hold up who pressed the key."""

    def __init__(self, mux: str) -> None:
        """`mux` is the name of the node that offers `stop`, `release` and `set_obstacle_stop`."""
        self._mux = mux
        self._lock = threading.Lock()
        self._stopped: bool | None = None
        self._active = ""
        self._asked: MuxRequest | None = None
        self._asked_at = 0.0
        self._number = 0
        self._problem = ""
        self._obstacles = NO_REPORT
        self._subscriber = rospy.Subscriber(f"{mux}/stopped", Bool, self._on_stopped, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber(f"{mux}/active", String, self._on_active, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber(f"{mux}/obstacle_stop", String, self._on_obstacles, queue_size=1, tcp_nodelay=True)

    def view(self) -> MuxView:
        """Return the newest state."""
        connected = self._subscriber.get_num_connections() > 0
        with self._lock:
            return view_of(connected, self._stopped, self._active, self._asked, self._problem, self._obstacles)

    def ask(self, request: MuxRequest) -> None:
        """Stop everything that drives, release the emergency stop, or turn the obstacle stop on or off."""
        with self._lock:
            now = time.monotonic()
            if self._asked == request and now - self._asked_at < _PATIENCE:
                return
            self._asked, self._asked_at, self._problem = request, now, ""
            self._number += 1
            number = self._number
        threading.Thread(target=self._call, args=(request, number), daemon=True).start()

    def _call(self, request: MuxRequest, number: int) -> None:
        emergency = request in ("stop", "release")
        service = rospy.resolve_name(f"{self._mux}/{request if emergency else 'set_obstacle_stop'}")
        problem = ""
        try:
            if emergency:
                answer = rospy.ServiceProxy(service, Trigger)()
            else:
                answer = rospy.ServiceProxy(service, SetBool)(request == "obstacles on")
            problem = "" if answer.success else describe_refusal(request, f"service {service}: {answer.message}")
        except (rospy.ServiceException, rospy.ROSException, OSError):
            problem = describe_refusal(request, f"service {service} does not answer: is the robot running?")
        with self._lock:
            if number != self._number:
                return  # asked for something else since
            self._asked, self._problem = None, problem
            if not problem and emergency:
                self._stopped = request == "stop"

    def _on_stopped(self, message: Bool) -> None:
        with self._lock:
            self._stopped = bool(message.data)

    def _on_obstacles(self, message: String) -> None:
        report = read_report(message.data)
        with self._lock:
            self._obstacles = report or NO_REPORT

    def _on_active(self, message: String) -> None:
        with self._lock:
            self._active = message.data
