"""Services of a node: those that it offers, and those that it calls."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Client, Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ur.source.diagnostic import UserError
from ur_nodes.codecs import find_offered, find_service
from ur_nodes.codecs.dialect import ServiceFailureError, Transforms, parts_of
from ur_nodes.codecs.frames import Newest, fill_transforms, transforms_of
from ur_nodes.loop import Loop
from ur_nodes.ports.log import Log
from ur_nodes.ports.services import READING
from ur_nodes.ports.validation import usable
from ur_nodes.ports.values import Result, Transform
from ur_nodes.ros2.ends import MessageSender, Receiver
from ur_nodes.ros2.names import resolve

if TYPE_CHECKING:
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Client

Value = TypeVar("Value")

_Callback = Callable[[tuple[Transform, ...]], None]

_MOVING = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
_MOVING_TAKEN = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE)  # a history with gaps is of no use
_FIXED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_FIXED_TAKEN = QoSProfile(
    depth=100, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)


class TransformTopics:
    """Sends and receives transforms. Publishers are made with the first transform of their kind."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._moving: MessageSender | None = None
        self._newest = Newest()
        self._fixed: MessageSender | None = None
        self._kept: dict[str, Transform] = {}  # a latched topic keeps one message: all fixed ones go together

    def listen(self, callback: _Callback, fixed_callback: _Callback) -> None:
        """Pass all transforms to a function, on any thread; static ones are sent once, and must not be lost."""
        Receiver(
            self._node, Transforms, "/tf_static", _FIXED_TAKEN, lambda m: fixed_callback(transforms_of(m, fixed=True))
        )
        Receiver(self._node, Transforms, "/tf", _MOVING_TAKEN, lambda message: callback(transforms_of(message)))

    def send(self, transforms: tuple[Transform, ...]) -> None:
        """Send transforms together."""
        fixed = {each.child: each for each in transforms if each.fixed}
        moving = tuple(each for each in transforms if not each.fixed)
        if fixed:
            self._kept |= fixed
            self._fixed = self._fixed or MessageSender(self._node, Transforms, "/tf_static", _FIXED)
            self._fixed.send(_message(tuple(self._kept.values())))
        if moving:
            self._newest.note(moving)
            self._moving = self._moving or MessageSender(self._node, Transforms, "/tf", _MOVING, self._greet)
            self._moving.send(_message(moving))

    def _greet(self) -> None:
        """Send the newest moving transforms again: nodes that have them ignore them."""
        if self._moving is not None and (transforms := self._newest.get()):
            self._moving.send(_message(transforms))


def _message(transforms: tuple[Transform, ...]) -> Transforms:
    message = Transforms()
    fill_transforms(message, transforms)
    return message


_LOOK_FOR_SERVICE = 0.02  # s
_ASK_AGAIN = 3.0  # s: the server drops an answer while it does not know all of its client


class NodeServices:
    """Requests and answers are handled on the thread of `loop`."""

    def __init__(self, node: Node, executor: SingleThreadedExecutor, loop: Loop, log: Log) -> None:
        self._node, self._executor, self._loop, self._log = node, executor, loop, log
        self._group = ReentrantCallbackGroup()  # a request that is answered later holds up no other
        self._clients: dict[tuple[str, type], Client] = {}

    def serve(
        self, service: str, kind: type[Value], callback: Callable[[Value, Callable[[Result], None]], None]
    ) -> None:
        """See `ports.node.Node.serve_later`."""
        codec = find_offered(kind)
        if codec is None:
            return
        name = resolve(self._node, service)

        async def respond(message: object, _response: object) -> object:
            done = rclpy.Future(executor=self._executor)

            def give(result: Result) -> None:
                try:
                    response = codec.response(result)
                except ServiceFailureError as problem:  # ROS 2 has no way to say it
                    self._log.error(f"{name}: {problem}")
                    response = parts_of(codec.service_class)[1]()
                done.set_result(response)
                self._executor.wake()

            def work() -> None:
                try:
                    request = usable(codec.request_of(message))
                except (ValueError, UserError) as problem:
                    give(Result(False, str(problem)))
                    return
                callback(request, give)

            self._loop.post(work)
            return await done

        self._node.create_service(codec.service_class, name, respond, callback_group=self._group)

    def call(self, service: str, request: object, callback: Callable[[Result], None], within: float) -> None:
        """See `ports.node.Node.call`."""
        codec = find_service(type(request))
        name, key = resolve(self._node, service), (service, type(request))
        if key not in self._clients:
            self._clients[key] = self._node.create_client(codec.service_class, name)
        client = self._clients[key]
        waiting = [callback]

        def give(result: Result) -> None:
            if waiting:
                waiting.pop()(result)

        def on_answer(future: rclpy.Future) -> None:
            try:
                result = usable(codec.result_of(future.result()))
            except (UserError, ValueError, RuntimeError) as problem:
                result = Result(False, str(problem))
            self._loop.post(lambda: give(result))

        def ask() -> None:
            if not waiting:
                return
            if client.service_is_ready():
                client.call_async(codec.request(request)).add_done_callback(on_answer)
                if isinstance(request, READING):
                    self._loop.after(_ASK_AGAIN, ask, steady=True)
            else:
                self._loop.after(_LOOK_FOR_SERVICE, ask, steady=True)

        ask()
        late = Result(False, f"no answer of {name} within {within:g} s")
        self._loop.after(within, lambda: give(late), steady=True)
