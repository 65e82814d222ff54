"""Effects of events, and actions besides nodes: lines, the end of the run, steps of lifecycle nodes."""

from typing import Any, cast

from ur.launchfile.plan.specs import Trigger
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.nodes import Nodes
from ur.launchfile.ros2.python.objects import EventFunction, Function
from ur.launchfile.ros2.substitutions import perform


class Events(Nodes):
    """Visits event handlers and actions that start nothing."""

    def _register(self, made: Made) -> None:
        handler = made.get("event_handler")
        if isinstance(handler, Unknown):
            self._on_gap(handler, self._context.chain)
            return
        if not isinstance(handler, Made) or handler.kind not in _HANDLERS:
            raise DescriptionProblem(
                "the event handler is none, expected OnProcessExit or another", "launch-value", made.span
            )
        kind, keyword = _HANDLERS[handler.kind]
        if not kind:
            if handler.kind == "EventHandler":
                self._on_gap(Unknown("what starts after this event", handler.span), self._context.chain)
            return
        self._kept.append(handler)
        number = self._handlers.setdefault(id(handler), len(self._handlers) + 1)
        target = handler.get("target_action", handler.get("target_lifecycle_node"))
        entities = handler.get(keyword)
        if isinstance(entities, Function):
            entities = Made("OpaqueFunction", {"function": EventFunction(entities, handler.span)}, handler.span)
        if isinstance(entities, (Made, list, tuple)):
            states = (self._state_of(handler, "start_state"), self._state_of(handler, "goal_state"))
            trigger = Trigger(cast("Any", kind), after=self._trigger, states=states, handler=number)
            self._when(entities, trigger, target if isinstance(target, Made) else None)
        elif entities is not None:
            self._on_gap(Unknown("a function decides what starts after this event", handler.span), self._context.chain)

    def _unregister(self, made: Made) -> None:
        handler = made.get("event_handler")
        number = self._handlers.get(id(handler))
        if isinstance(handler, Unknown) or (number is None and self._trigger is not None):
            reason = handler.reason if isinstance(handler, Unknown) else "the event handler that ends here"
            self._on_gap(Unknown(reason, made.span), self._context.chain)
        elif number is None:
            message = "the event handler is not registered, expected one of a RegisterEventHandler before"
            raise DescriptionProblem(message, "launch-value", made.place("event_handler"))
        elif self._trigger is None:  # before any event
            self._later = [each for each in self._later if each[1].handler != number]
            del self._handlers[id(handler)]
        else:
            self._act(made, "unregister", str(number))

    def _state_of(self, handler: Made, keyword: str) -> str:
        return self._text(handler.get(keyword), handler.span) if handler.get(keyword) is not None else ""

    def _key_of(self, target: Made) -> str:
        known = self._made.get(id(target))
        if known is not None:
            return known.key
        text = perform(target.get("name", target.get("executable", "")), self._context)
        return f"/{text}" if isinstance(text, str) else ""

    # -- what happens besides nodes

    def _log(self, made: Made) -> None:
        self._act(made, "log", self._text(made.get("msg", ""), made.place("msg")))

    def _shutdown(self, made: Made) -> None:
        self._act(made, "shutdown", self._text(made.get("reason", "reason not given"), made.span))

    def _emit(self, made: Made) -> None:
        event = made.get("event")
        kind = event.kind if isinstance(event, Made) else ""
        if isinstance(event, Made) and kind == "ShutdownEvent":
            self._shutdown(event)
            return
        matcher = event.get("lifecycle_node_matcher") if isinstance(event, Made) else None
        if not isinstance(event, Made) or kind != "ChangeState" or not isinstance(matcher, tuple) or len(matcher) != 2:
            reason = f"'ur launch' does not emit the event {kind or 'of this action'}"
            self._on_gap(Unknown(reason, made.span), self._context.chain)
            return
        target = matcher[1]
        node = self._key_of(target) if isinstance(target, Made) else self._text(target, made.span)
        self._act(made, "state", str(event.get("transition_id", "")), node)

    def _transition(self, made: Made) -> None:
        names, steps = made.get("lifecycle_node_names"), made.get("transition_ids")
        if not isinstance(names, (list, tuple)) or not isinstance(steps, (list, tuple)):
            self._on_gap(Unknown("the steps of lifecycle nodes", made.span), self._context.chain)
            return
        words = " ".join(str(each) if isinstance(each, int) else self._text(each, made.span) for each in steps)
        for name in names:
            self._act(made, "state", words, self._text(name, made.span))

    def _timer(self, made: Made) -> None:
        period = self._text(made.get("period", "0"), made.span)
        try:
            seconds = float(period)
        except ValueError:
            raise DescriptionProblem(
                f"the period is '{period}', expected seconds", "bad-number", made.place("period")
            ) from None
        self._when(made.get("actions") or [], Trigger("timer", seconds=seconds, after=self._trigger))


_HANDLERS = {
    "EventHandler": ("", ""),
    "OnExecutionComplete": ("exit", "on_completion"),
    "OnIncludeLaunchDescription": ("", ""),
    "OnProcessExit": ("exit", "on_exit"),
    "OnProcessIO": ("output", "on_stdout"),
    "OnProcessStart": ("start", "on_start"),
    "OnShutdown": ("shutdown", "on_shutdown"),
    "OnStateTransition": ("state", "entities"),
}
