"""Offers the topics of a master to viewers by foxglove-sdk: bytes of ROS 1 pass through and are never decoded.

    python -I -m ur_nodes ur_nodes.web.viewers.viewer_endpoint_node LINK

LINK is the descriptor of a socket. A line of JSON leaves by it: `host` and `port` of the server. The node ends when it
is closed, or when another master has started. It subscribes to a topic while a viewer does.

The server takes every client that reaches it, web pages of all sites included. So it takes no messages of viewers, and
listens at an address of the loopback interface that is drawn by chance: another site would have to try 2^39 pairs of
address and port. Users of this computer can find it, as they can reach the master.
"""

import secrets
import socket
import sys
from functools import partial

import foxglove
from foxglove.websocket import ChannelView, Client, ServerListener

from ur_nodes.ports.node import Node
from ur_nodes.web.server_link import Outlet, read_lines, run_for_server
from ur_nodes.web.viewers.advertised_topics import AdvertisedTopics

_BACKLOG = 64  # messages that wait for a slow viewer; older ones are dropped


class _Listener(ServerListener):
    """Passes on, from a thread of the server, that viewers subscribe and unsubscribe."""

    def __init__(self, node: Node, offers: AdvertisedTopics) -> None:
        self._node, self._offers = node, offers

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:  # noqa: ARG002 - the server's interface
        self._node.post(partial(self._offers.change, channel.topic, 1))

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:  # noqa: ARG002 - likewise
        self._node.post(partial(self._offers.change, channel.topic, -1))


def main() -> int:
    """Run until the server has ended. Returns the exit code."""
    return run_for_server("web_viewers", start)


def start(node: Node, link: socket.socket) -> None:
    """Serve viewers, and send the address."""
    context = foxglove.Context()

    def open_channel(name: str, kind: str, schema: str) -> foxglove.Channel:
        described = foxglove.Schema(name=kind, encoding="ros1msg", data=schema.encode())
        return foxglove.Channel(name, schema=described, message_encoding="ros1", context=context)

    offers = AdvertisedTopics(node, open_channel, lambda line: sys.stderr.write(f"{line}\n"))
    host = "127." + ".".join(str(1 + secrets.randbelow(254)) for _ in range(3))
    server = foxglove.start_server(
        name="ur",
        host=host,
        port=0,
        server_listener=_Listener(node, offers),
        context=context,
        message_backlog_size=_BACKLOG,
    )
    node.on_end(server.stop)
    read_lines(node, {link: lambda _: None})
    Outlet(node, link).send_line({"host": host, "port": server.port})


if __name__ == "__main__":
    sys.exit(main())
