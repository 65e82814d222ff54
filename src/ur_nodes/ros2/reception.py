"""Reception of messages without rclpy's executor, which makes a new wait set twice for each message.

The node's thread waits for messages itself, as for calls, so none is handed from one thread to another. There is no
wait set: the middleware's own thread writes into a file (eventfd) for each message, by the C function `eventfd_write`
as callback of rcl, and the thread polls these files. Services, clients, events of publishers and timers stay with the
executor. Subscriptions have no events: an executor that waits for these is woken by each message. `ur doctor` names
publishers whose messages a subscription does not get. During a callback the simulated clock of a node stands still.
"""

from __future__ import annotations

import ctypes
import inspect
import os
import queue
import select
import sys
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, cast

import rclpy.node
from rclpy.callback_groups import CallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Subscription, SubscriptionEventCallbacks
from rclpy.qos import HistoryPolicy

from ur.source.diagnostic import user_error

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor
    from rclpy.qos import QoSProfile

_MOST_AT_ONCE = 20  # messages of a topic, while others wait
_FLAGS = os.EFD_CLOEXEC | os.EFD_NONBLOCK
_WRITTEN = select.EPOLLIN | select.EPOLLET  # each time, so that nothing has to be read
_OnMessages = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_size_t)
_COUNT = (  # into the file whose number is the pointer; its arguments are of these sizes on 64 bits only
    _OnMessages(("eventfd_write", ctypes.CDLL(None))) if sys.maxsize > 2**32 else _OnMessages(os.eventfd_write)
)


class Unserved(CallbackGroup):
    """Leaves executors no work."""

    def can_execute(self, entity: object) -> bool:  # noqa: ARG002
        """See CallbackGroup: no executor may."""
        return False

    def beginning_execution(self, entity: object) -> bool:  # noqa: ARG002
        """See CallbackGroup."""
        return False


class Reception(Unserved):
    """The calls that wait for the node's thread; while none does, that thread receives the messages of subscriptions.

    See `ur_nodes.loop.Calls`.
    """

    def __init__(self) -> None:
        super().__init__()
        self._calls: deque[Callable[[], None]] = deque()
        self._turns = 0  # calls until messages are looked for although others wait
        self.holds = False  # messages wait for the time-out of `get`, or for a call of another thread
        self._more = False  # messages wait although some of their topic were received
        self._thread = 0  # that receives
        self._wake = os.fdopen(os.eventfd(0, _FLAGS), "wb", buffering=0)
        self._poll = select.epoll()
        self._wakes = select.epoll()
        for poll in (self._poll, self._wakes):
            poll.register(self._wake, _WRITTEN)
        self._subscriptions: dict[int, tuple[Subscription, bool, int]] = {}  # by file; details? messages at once

    def put(self, call: Callable[[], None]) -> None:
        self._calls.append(call)
        if threading.get_ident() != self._thread:
            with suppress(ValueError):  # the node has ended
                self._wake.write((1).to_bytes(8, sys.byteorder))

    def get(self, *, timeout: float) -> Callable[[], None]:
        if not (self._calls and self._turns):
            self._receive(0.0 if self._calls else timeout)
            self._turns = len(self._calls)
        if not self._calls:
            raise queue.Empty
        self._turns -= 1
        return self._calls.popleft()

    def comes_first(self) -> bool:
        """Return whether messages that were held wait, which come before the timer that they were held for."""
        return self.holds and self._turns > 0

    def close(self) -> None:
        """Close the files, after the subscriptions were destroyed and the thread has ended."""
        self._wake.close()
        self._wakes.close()
        self._poll.close()

    def add_entity(self, entity: object) -> None:
        """See CallbackGroup: a subscription has been made."""
        super().add_entity(entity)
        subscription = cast("Subscription", entity)
        file = os.eventfd(0, _FLAGS)
        profile = subscription.qos_profile
        most = 1 if (profile.history, profile.depth) == (HistoryPolicy.KEEP_LAST, 1) else _MOST_AT_ONCE
        self._subscriptions[file] = subscription, accepts_details(subscription.callback), most
        self._poll.register(file, _WRITTEN)
        _call_with_messages(subscription, _COUNT, file)

    def drop(self, subscription: Subscription) -> None:
        """Stop receiving for a subscription."""
        for file in [file for file, (each, *_) in self._subscriptions.items() if each is subscription]:
            _call_with_messages(subscription, _OnMessages(), file)
            del self._subscriptions[file]
            os.close(file)

    def _receive(self, seconds: float) -> None:
        """Wait for messages or a call, at most so long, and make the callbacks of subscriptions, which put calls."""
        self._thread = threading.get_ident()
        if self.holds and seconds and not self._more:
            self._wakes.poll(seconds)
        self._more = False
        for file, _ in self._poll.poll(0.0 if self.holds else seconds):
            with suppress(rclpy_implementation.InvalidHandle, OSError):  # another thread has destroyed it
                if file in self._subscriptions and self._take(*self._subscriptions[file]):
                    self._more = True
                    os.eventfd_write(file, 1)

    def _take(self, subscription: Subscription, detailed: bool, most: int) -> bool:
        """Receive messages; return whether more may wait."""
        handle = subscription.handle
        with handle:
            for _ in range(most):
                taken = handle.take_message(subscription.msg_type, subscription.raw)
                if taken is None:
                    return False
                message, info = taken
                subscription.callback(*((message, info) if detailed else (message,)))
        return most > 1


def _call_with_messages(subscription: Subscription, call: ctypes._FuncPointer, file: int) -> None:
    """Have a function called for new messages of a subscription, and for those that wait; null: none."""
    rcl, handle = ctypes.CDLL("librcl.so"), ctypes.c_void_p(subscription.handle.pointer)
    if rcl.rcl_subscription_set_on_new_message_callback(handle, call, ctypes.c_void_p(file)):
        message = "this middleware does not tell when messages arrive, expected Fast DDS or Cyclone DDS"
        raise user_error(message, rule="bad-middleware", help="export RMW_IMPLEMENTATION=rmw_fastrtps_cpp")


def accepts_details(callback: Callable[..., object]) -> bool:
    """Return whether a callback takes the middleware's information beside the message: rclpy's rule from Iron on."""
    try:
        inspect.signature(callback).bind(None)
    except TypeError:
        return True
    return False


class ReceivingNode(rclpy.node.Node):
    """A node of rclpy whose subscriptions, where they are in no other callback group, are in its reception."""

    def __init__(self, name: str) -> None:
        self.reception = Reception()  # a node subscribes to the clock when it is made
        self.describe: Callable[[str], ParameterDescriptor | None] = lambda _name: None
        super().__init__(name, automatically_declare_parameters_from_overrides=True)

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """See rclpy's Node. What `describe` returns is for other programs: rclpy checks by its own."""
        return self.describe(name) or super().describe_parameter(name)

    def create_subscription(
        self,
        msg_type: object,
        topic: str,
        callback: Callable[..., object],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        raw: bool = False,
    ) -> Subscription:
        """See rclpy's Node."""
        return super().create_subscription(
            msg_type,
            topic,
            callback,
            qos_profile,
            callback_group=callback_group or self.reception,
            event_callbacks=event_callbacks or SubscriptionEventCallbacks(use_default_callbacks=False),
            raw=raw,
        )

    def create_service(
        self,
        srv_type: object,
        srv_name: str,
        callback: Callable[..., object],
        *,
        qos_profile: QoSProfile | None = None,  # noqa: ARG002
        callback_group: CallbackGroup | None = None,
    ) -> object:
        """See rclpy's Node. All services keep 10 requests; rclpy's own for parameters would hold memory for 1000."""
        return super().create_service(srv_type, srv_name, callback, callback_group=callback_group)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """See rclpy's Node."""
        self.reception.drop(subscription)
        return super().destroy_subscription(subscription)
