"""Reception of messages without rclpy's executor, which makes a new wait set twice for each message.

The wait set here is kept until subscriptions are added or closed. It needs rclpy's own module `_rclpy_pybind11`, by the
calls with which rclpy's executor uses it. Services, clients, events of publishers and timers stay with the executor.
Subscriptions have no events: an executor that waits for these is woken by each message. `ur doctor` names publishers
whose messages a subscription does not get.
"""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING, cast

import rclpy.node
import rclpy.utilities
from rclpy.callback_groups import CallbackGroup
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import SubscriptionEventCallbacks

from ur_nodes.loop import Worker

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor
    from rclpy.node import Context, Subscription
    from rclpy.qos import QoSProfile

_MOST_AT_ONCE = 20  # messages of a topic, while others wait
_RELEASE = 1.0  # s for the thread to leave a subscription


class Reception(CallbackGroup):
    """Calls the callbacks of its subscriptions on its own thread; as a callback group it leaves executors no work."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self._context = context
        self._guard = GuardCondition(None, None, context=context)
        self._subscriptions: tuple[Subscription, ...] = ()  # replaced by one thread, the node's
        self._held: tuple[Subscription, ...] = ()  # by the reception's thread
        self._released = threading.Condition()
        self._changed = self._closed = False
        self._worker = Worker("reception")

    def start(self) -> None:
        """Start the thread."""
        self._worker.add(self._receive)

    def close(self, within: float) -> None:
        """Stop the callbacks; wait at most `within` s for the running one."""
        self._closed = True
        self._guard.trigger()
        self._worker.end()
        self._worker.join(within)

    def add_entity(self, entity: object) -> None:
        """See CallbackGroup: a subscription has been made."""
        super().add_entity(entity)
        self._change((*self._subscriptions, cast("Subscription", entity)))

    def drop(self, subscription: Subscription) -> None:
        """Stop receiving for a subscription. While the thread holds it, its topic can have no other type."""
        self._change(tuple(each for each in self._subscriptions if each is not subscription))
        with self._released:
            self._released.wait_for(lambda: subscription not in self._held, _RELEASE)

    def can_execute(self, entity: object) -> bool:  # noqa: ARG002
        """See CallbackGroup: no executor may."""
        return False

    def beginning_execution(self, entity: object) -> bool:  # noqa: ARG002
        """See CallbackGroup."""
        return False

    def ending_execution(self, entity: object) -> None:
        """See CallbackGroup."""

    def _change(self, subscriptions: tuple[Subscription, ...]) -> None:
        with self._released:
            self._subscriptions, self._changed = subscriptions, True
        self._guard.trigger()

    def _receive(self) -> None:
        while not self._closed:
            with ExitStack() as held:
                # Keep the subscriptions alive; returns the live ones by their addresses
                with self._released:
                    self._changed, self._held = False, self._subscriptions
                found: dict[int, tuple[Subscription, bool]] = {}
                for each in self._held:
                    try:
                        held.enter_context(each.handle)
                    except rclpy_implementation.InvalidHandle:
                        continue
                    found[each.handle.pointer] = each, accepts_details(each.callback)
                self._receive_from(found, held)
            with self._released:
                self._held = ()
                self._released.notify_all()

    def _receive_from(self, subscriptions: dict[int, tuple[Subscription, bool]], held: ExitStack) -> None:
        """Receive until the subscriptions change; each is given with whether its callback takes details."""
        context, guard = self._context.handle, self._guard.handle
        held.enter_context(context)
        held.enter_context(guard)
        waiters = rclpy_implementation.WaitSet(len(subscriptions), 1, 0, 0, 0, 0, context)
        while not (self._changed or self._closed):
            waiters.clear_entities()
            for each, _ in subscriptions.values():
                waiters.add_subscription(each.handle)
            waiters.add_guard_condition(guard)
            waiters.wait(-1)
            for address in waiters.get_ready_entities("subscription"):
                self._take(*subscriptions[address])

    def _take(self, subscription: Subscription, detailed: bool) -> None:
        for _ in range(_MOST_AT_ONCE):
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None or self._closed:
                return
            message, info = taken
            subscription.callback(*((message, info) if detailed else (message,)))


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
        self.reception = Reception(
            rclpy.utilities.get_default_context()
        )  # a node subscribes to the clock when it is made
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
