"""Several clients of a mux in one process, for the tests: a JSON request a line in, a JSON answer a line out."""

from __future__ import annotations

import json
import os
import signal
import time
from dataclasses import replace
from typing import Any

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import String, Time
from tests.json_client import answer_requests, claim_output, wait_until

from ur_nodes.motion.challenge.link import FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.ports import values
from ur_nodes.ros1.node import RosNode

AHEAD = values.Twist(0.3, 0.0)


class Clients:
    def __init__(self) -> None:
        self.node = RosNode()
        self.node.begin()
        self.clients: dict[str, LeaseClient] = {}
        self.fresh: dict[str, FreshPublisher] = {}
        self.speeds: list[float] = []
        self.requests = rospy.Publisher("cmd_vel_mux/lease_request", String, queue_size=1)
        self.challenges: list[Any] = []
        rospy.Subscriber("cmd_vel", Twist, lambda message: self.speeds.append(message.linear.x), queue_size=100)
        rospy.Subscriber("cmd_vel_mux/challenge", Time, lambda message: self.challenges.append(message.data))

    def ready(self) -> None:
        """Once a mux is there, with all its connections."""
        before = len(self.challenges)
        wait_until(
            lambda: len(self.challenges) > before + 5 and self.requests.get_num_connections() > 0, 60.0, "the mux"
        )

    def join(self, client: str, conduct: str) -> dict[str, Any]:
        """A client begins, with `drive` by a command; an earlier one of this id is silent from now on."""
        if client in self.clients:
            self.vanish(client)
        os.environ |= {"UR_CLIENT": client, "UR_CLIENT_NAME": f"{client}-host", "UR_LEASE": conduct}
        self.node.ask(lambda: self.add(client))
        joined = self.clients[client]
        wait_until(lambda: bool(self.fresh[client].subscribers()) and joined.view().state != "unknown", 60.0, "the mux")
        if conduct == "drive":
            self.node.ask(joined.acquire)
        return self.view(client)

    def add(self, client: str) -> None:
        self.clients[client] = joined = LeaseClient(self.node, "cmd_vel_mux", "test")
        self.fresh[client] = FreshPublisher("key_vel", joined.link, client)

    def view(self, client: str) -> dict[str, Any]:
        seen = self.clients[client].view()
        told = {name: getattr(seen, name) for name in ("state", "holder", "program", "mine", "taken_by")}
        return told | {"asking": list(seen.asking)}

    def becomes(self, client: str, **expected: Any) -> dict[str, Any]:
        """Once the client's view is so."""
        try:
            wait_until(
                lambda: all(self.view(client)[name] == value for name, value in expected.items()), 60.0, str(expected)
            )
        except TimeoutError as problem:
            raise TimeoutError(f"{problem}; it is {self.view(client)}") from None
        return self.view(client)

    def request(self, client: str, action: str) -> None:
        self.node.ask(getattr(self.clients[client], action))

    def leave(self, client: str) -> None:
        """The client releases what it has and is silent from now on."""
        self.node.ask(self.clients[client].release)

    def vanish(self, client: str) -> None:
        """The client is silent from now on, like one that was killed."""
        own = self.clients[client]

        def fall_silent() -> None:
            own._requests = replace(own._requests, silent=True)

        self.node.ask(fall_silent)

    def drive(self, client: str, count: int) -> list[float]:
        """Fresh commands of a client; what came of them."""
        del self.speeds[:]
        for _ in range(count):
            self.node.ask(lambda: self.send_ahead(client))
            time.sleep(1.0 / 30.0)
        return self.rest()

    def send_ahead(self, client: str) -> None:
        self.fresh[client].send(AHEAD)

    def rest(self) -> list[float]:
        """Once nothing is commanded any more: what was."""
        count = -1
        while count != len(self.speeds):
            count = len(self.speeds)
            time.sleep(0.4)
        return self.speeds[:]

    def parameter(self) -> str:
        return str(rospy.get_param("/ur/lease"))

    def take_and_kill(self, client: str, pid: int) -> str:
        """The client takes over, and the mux is killed as soon as that is announced; what was announced."""
        announced: list[str] = []

        def on_lease(message: String) -> None:
            if json.loads(message.data)["client"] == client and not announced:
                os.kill(pid, signal.SIGKILL)
                announced.append(message.data)

        subscriber = rospy.Subscriber("cmd_vel_mux/lease", String, on_lease, queue_size=1, tcp_nodelay=True)
        wait_until(lambda: subscriber.get_num_connections() > 0, 60.0, "the mux")
        self.node.ask(self.clients[client].take_over)
        wait_until(lambda: bool(announced), 60.0, "the lease")
        subscriber.unregister()
        rospy.set_param("/ur/lease", "")  # the mirror may have been late
        return announced[0]

    def mirrored(self, client: str, state: str = "held") -> None:
        """Once the parameter server has the lease of the client in this state, too."""

        def same() -> bool:
            lease = json.loads(rospy.get_param("/ur/lease", "") or "{}")
            return (lease.get("client"), lease.get("state")) == (client, state)

        wait_until(same, 60.0, "the parameter")


if __name__ == "__main__":
    ANSWERS = claim_output()
    rospy.init_node("clients")
    answer_requests(ANSWERS, Clients())
