"""Numbers of topics over time, for the plots that pages show: any numeric field of any topic, while a page plots it."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial

from ur.web.wire.frames import Kind, Layer, json_frame
from ur.web.wire.requests import PLOT, split_plot
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.messages.decode import BadMessageError, read_number
from ur_nodes.web.messages.definition import PRIMITIVES, BadDefinitionError, Definition, read_definition

_EVERY = 0.1  # s between two samples of all plots
_LOOK_EVERY = 3.0  # s between two looks for topics
_MOST_PLOTS = 24  # of all pages
_MOST_FIELDS = 1000  # of all topics that are offered
_DEEPEST = 5
_LONGEST = 1 << 20  # bytes of a message that is read

Topic = tuple[str, str]


class PlotFeed:
    """Samples what pages plot, once for all of them. Messages are read at most at the rate of samples.

    `list_topics` lists names and types of topics, as far as they are known.
    """

    def __init__(self, node: Node, send: Callable[[bytes], None], list_topics: Callable[[], Sequence[Topic]]) -> None:
        self._node, self._send, self._list_topics = node, send, list_topics
        self._open = self._asking = self._sampling = False
        self._plots: frozenset[str] = frozenset()
        self._subscriptions: dict[str, Subscription] = {}
        self._newest: dict[str, RawMessage] = {}
        self._fields: dict[str, list[str]] = {}  # by type
        self._offered: dict[str, list[str]] = {}
        self._send_every, self._look_every = Every(_EVERY), Every(_LOOK_EVERY)

    def want(self, plots: Collection[str], *, shown: bool) -> None:
        """Choose the plots (`TOPIC:FIELD`) to sample; with `shown`, a page also lists all fields."""
        good = frozenset(sorted(plot for plot in plots if PLOT.fullmatch(plot))[:_MOST_PLOTS])
        if (shown and not self._open) or good - self._plots:
            self._look_every.hurry()
        self._open, self._plots = shown, good

    def step(self, now: float) -> None:
        """Subscribe to the topics of the plots, and send samples; to be called often. `now` is `Node.steady`."""
        if self._look_every.due(now):
            self._look()
        if not self._send_every.due(now):
            return
        if self._newest and not self._sampling:
            self._sampling = True
            job = partial(sample_all, self._plots, self._newest)
            self._newest = {}
            self._node.work(job, partial(self._pass_on, now), "plots")

    def _pass_on(self, now: float, values: dict[str, float]) -> None:
        self._sampling = False
        if values:
            self._send(json_frame(Kind.VALUES, {"t": round(now, 3), "v": values}, Layer.PLOTS))

    def _look(self) -> None:
        topics = {split_plot(plot)[0] for plot in self._plots}
        kinds = dict(self._list_topics()) if topics or self._open else {}
        if (topics or self._open) and not kinds:
            self._look_every.hurry()  # they are not known yet
        for topic in self._subscriptions.keys() - (topics & kinds.keys()):
            self._subscriptions.pop(topic).close()
            self._newest.pop(topic, None)
        for topic in (topics & kinds.keys()) - self._subscriptions.keys():
            self._subscriptions[topic] = self._node.raw.subscribe(topic, partial(self._on_message, topic))
        if self._open and not self._asking:
            self._asking = True
            new = {kind for kind in kinds.values() if kind not in self._fields}
            self._node.work(lambda: self._find_fields(new), partial(self._offer, kinds), "fields")

    def _on_message(self, topic: str, message: RawMessage) -> None:
        self._newest[topic] = message

    def _find_fields(self, kinds: Collection[str]) -> dict[str, list[str]]:
        """Return the numeric fields of types, none for types that are not installed; runs on a worker."""
        found = {}
        for kind in kinds:
            schema = self._node.raw.find_schema(kind)
            try:
                found[kind] = [] if schema is None else list_fields(read_definition(kind, schema))
            except BadDefinitionError:
                found[kind] = []
        return found

    def _offer(self, kinds: dict[str, str], new: dict[str, list[str]]) -> None:
        """Send the fields that may be plotted, by topic, where they have changed."""
        self._asking = False
        self._fields |= new
        offered, count = {}, 0
        for topic, kind in sorted(kinds.items()):
            fields = [each for each in self._fields[kind] if PLOT.fullmatch(f"{topic}:{each}")]
            count += len(fields)
            if count > _MOST_FIELDS:
                break
            if fields:
                offered[topic] = fields
        if offered != self._offered:
            self._offered = offered
            self._send(json_frame(Kind.FIELDS, {"fields": offered}, Layer.PLOTS))


def list_fields(definition: Definition, deepest: int = _DEEPEST) -> list[str]:
    """Return the numeric fields of a type as paths with dots, without arrays, headers and times."""
    return list(_walk(definition, definition.kind, "", deepest))


def _walk(definition: Definition, kind: str, before: str, deepest: int) -> Iterator[str]:
    if deepest == 0 or kind == "std_msgs/Header":
        return
    for field in definition.fields[kind]:
        if field.length is not None:
            continue
        if field.kind in PRIMITIVES:
            yield f"{before}{field.name}"
        elif field.kind in definition.fields:
            yield from _walk(definition, field.kind, f"{before}{field.name}.", deepest - 1)


def sample_all(plots: Iterable[str], newest: Mapping[str, RawMessage]) -> dict[str, float]:
    """Return the number of each plot, from the newest message of its topic."""
    values = {}
    for plot in plots:
        topic, path = split_plot(plot)
        number = sample(newest[topic], path) if topic in newest else None
        if number is not None:
            values[plot] = number
    return values


def sample(message: RawMessage, path: str) -> float | None:
    """Return the number at a path of a message; None if there is none or it is not finite."""
    if len(message.data) > _LONGEST:
        return None
    try:
        number = read_number(read_definition(message.type_name, message.schema), message.data, path)
    except (BadDefinitionError, BadMessageError):
        return None
    return None if number is None else float(f"{number:.6g}")
