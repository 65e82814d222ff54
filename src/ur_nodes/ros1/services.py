"""Servers and clients of services of ROS 1, on the node's thread."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

import rospy
from tf2_msgs.msg import TFMessage

from ur.source.diagnostic import UserError
from ur_nodes.codecs import find_offered, find_service
from ur_nodes.codecs.dialect import ServiceFailureError
from ur_nodes.codecs.frames import Newest, fill_transforms, transforms_of
from ur_nodes.loop import Loop, run_aside
from ur_nodes.ports.validation import usable
from ur_nodes.ports.values import Result, Transform
from ur_nodes.ros1.ending import quiet_at_end

_Callback = Callable[[tuple[Transform, ...]], None]


class TransformTopics:
    """Sends and receives transforms. Each publisher is made for its first transform."""

    def __init__(self) -> None:
        self._moving: rospy.Publisher | None = None
        self._newest = Newest()
        self._fixed: rospy.Publisher | None = None
        self._kept: dict[str, Transform] = {}  # a latched topic keeps one message: all fixed ones go together

    def listen(self, callback: _Callback, fixed_callback: _Callback) -> None:
        """Pass all transforms to functions, on any thread; fixed ones arrive once, and must not be lost."""
        rospy.Subscriber(
            "/tf_static", TFMessage, lambda message: fixed_callback(transforms_of(message, fixed=True)), queue_size=100
        )
        rospy.Subscriber(
            "/tf", TFMessage, lambda message: callback(transforms_of(message)), queue_size=200, tcp_nodelay=True
        )

    @quiet_at_end
    def send(self, transforms: tuple[Transform, ...]) -> None:
        """Send transforms together."""
        fixed = {each.child: each for each in transforms if each.fixed}
        moving = tuple(each for each in transforms if not each.fixed)
        if fixed:
            self._kept |= fixed
            self._fixed = self._fixed or rospy.Publisher("/tf_static", TFMessage, queue_size=100, latch=True)
            self._fixed.publish(_message(tuple(self._kept.values())))
        if moving:
            self._newest.note(moving)
            self._moving = self._moving or self._offer()
            self._moving.publish(_message(moving))

    def _offer(self) -> rospy.Publisher:
        publisher = rospy.Publisher("/tf", TFMessage, queue_size=100, tcp_nodelay=True)
        publisher.impl.add_subscriber_listener(_Greeter(publisher.impl, self._newest))
        return publisher


class _Greeter(rospy.SubscribeListener):
    """Sends the newest moving transforms to each new subscriber, and to no other one, on a thread of rospy's."""

    def __init__(self, implementation: rospy.topics._PublisherImpl, newest: Newest) -> None:
        super().__init__()
        self._implementation, self._newest = implementation, newest

    def peer_subscribe(self, _name: str, _send_all: object, send: Callable[[TFMessage], None]) -> None:
        """See rospy."""
        if transforms := self._newest.get():
            self._implementation.acquire()  # as rospy does for messages that it has latched
            try:
                send(_message(transforms))
            finally:
                self._implementation.release()


def _message(transforms: tuple[Transform, ...]) -> TFMessage:
    message = TFMessage()
    fill_transforms(message, transforms)
    return message


Value = TypeVar("Value")

_ANSWER_LIMIT = 60.0  # s


def serve_service(
    loop: Loop, service: str, kind: type[Value], callback: Callable[[Value, Callable[[Result], None]], None]
) -> None:
    """Serve requests of a kind; `callback` gets each one, and a function to call with the answer."""
    codec = find_offered(kind)
    if codec is None:
        return

    def respond(message: Any) -> Any:
        done: Future[Result] = Future()

        def work() -> None:
            try:
                request = usable(codec.request_of(message))
            except (ValueError, UserError) as problem:
                done.set_exception(rospy.ServiceException(str(problem)))
                return
            try:
                callback(request, done.set_result)
            except Exception as problem:
                done.set_exception(problem)
                raise

        loop.post(work)
        try:
            return codec.response(done.result(_ANSWER_LIMIT))
        except ServiceFailureError as problem:
            raise rospy.ServiceException(str(problem)) from None

    rospy.Service(service, codec.service_class, respond)


def find_in_ros(service: str, service_class: object, within: float) -> Callable[[object], object]:
    """Wait for a service at most `within` s; return the function that calls it. Raises rospy's errors."""
    rospy.wait_for_service(service, timeout=within)
    return rospy.ServiceProxy(service, service_class)


def call_service(
    loop: Loop,
    service: str,
    request: object,
    callback: Callable[[Result], None],
    within: float,
    find: Callable[[str, object, float], Callable[[object], object]] = find_in_ros,
) -> None:
    """Call a service; `callback` gets the answer, or a result without success after `within` s.

    A call that was reported as failed is not sent later, so that no late release ends an emergency stop.
    """
    codec = find_service(type(request))
    late = Result(False, f"no answer of {rospy.resolve_name(service)} within {within:g} s")
    waiting = [callback]

    def give(result: Result) -> None:
        if waiting:
            waiting.pop()(result)

    def ask() -> None:
        try:
            send = find(service, codec.service_class, within)
            if not waiting:
                return
            result = usable(codec.result_of(send(codec.request(request))))
        except Exception as problem:  # a server or a master that ends meanwhile fails in many ways
            result = Result(False, str(problem) or type(problem).__name__)
        loop.post(lambda: give(result))

    run_aside(ask)
    loop.after(within, lambda: give(late), steady=True)
