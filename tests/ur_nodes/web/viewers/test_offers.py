"""Topics that are offered to viewers, on a bus."""

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.web.viewers.advertised_topics import AdvertisedTopics

STRING, BOOL = "std_msgs/String", "std_msgs/Bool"


class FakeChannel:
    def __init__(self, name: str, kind: str, schema: str) -> None:
        self.name, self.kind, self.schema = name, kind, schema
        self.messages: list[bytes] = []
        self.open = True

    def log(self, data: bytes) -> None:
        self.messages.append(data)

    def close(self) -> None:
        self.open = False


class OffersWorld:
    def __init__(self) -> None:
        self.bus = Bus()
        self.bus.schemas.update({STRING: "string data\n", BOOL: "bool data\n"})
        self.robot = self.bus.node("robot")
        self.channels: list[FakeChannel] = []
        self.lines: list[str] = []
        self.offers = AdvertisedTopics(self.bus.node("viewers"), self.open, self.lines.append)

    def open(self, name: str, kind: str, schema: str) -> FakeChannel:
        self.channels.append(FakeChannel(name, kind, schema))
        return self.channels[-1]


def test_topic_is_offered_while_it_is_published() -> None:
    world = OffersWorld()
    world.robot.raw.publish("words", STRING)
    world.bus.run(1.5)
    (channel,) = world.channels
    assert (channel.name, channel.kind, channel.schema) == ("/words", STRING, "string data\n")
    world.robot.end("test")
    world.bus.run(1.5)
    assert not channel.open


def test_many_topics_are_offered_and_withdrawn_a_few_at_a_time() -> None:
    world = OffersWorld()
    for number in range(100):
        world.robot.raw.publish(f"words{number}", STRING)
    changes = []
    for _ in range(40):
        before = sum(each.open for each in world.channels)
        world.bus.run(0.05)
        changes.append(sum(each.open for each in world.channels) - before)
    assert sum(changes) == 100
    assert max(changes) <= 24
    world.robot.end("test")
    before = 100
    for _ in range(40):
        world.bus.run(0.05)
        left = sum(each.open for each in world.channels)
        assert before - left <= 24
        before = left
    assert before == 0


def test_topic_of_another_type_is_offered_anew() -> None:
    world = OffersWorld()
    world.robot.raw.publish("words", STRING)
    world.bus.run(1.5)
    world.robot.end("test")
    world.bus.node("robot").raw.publish("words", BOOL)
    world.bus.run(1.5)
    assert [(each.kind, each.open) for each in world.channels] == [(STRING, False), (BOOL, True)]


def test_type_that_is_not_installed_is_reported_once() -> None:
    world = OffersWorld()
    world.bus.schemas["strange/Type"] = "string data\n"
    world.robot.raw.publish("strange", "strange/Type")
    del world.bus.schemas["strange/Type"]
    world.bus.run(5.0)
    assert world.channels == []
    assert world.lines == ["/strange: not offered: strange/Type is not installed on this computer"]


def test_topic_is_subscribed_to_while_a_viewer_wants_it() -> None:
    world = OffersWorld()
    words = world.robot.raw.publish("words", STRING)
    world.bus.run(1.5)
    world.offers.change("/words", 1)
    world.offers.change("/words", 1)
    world.offers.change("/nothing", 1)
    words.send(b"one")
    world.bus.run(0.1)
    world.offers.change("/words", -1)
    assert words.subscribers() == 1
    world.offers.change("/words", -1)
    assert words.subscribers() == 0
    words.send(b"two")
    world.bus.run(0.1)
    assert world.channels[0].messages == [b"one"]


def test_viewer_that_subscribes_later_gets_what_the_topic_keeps() -> None:
    world = OffersWorld()
    world.robot.raw.publish("kept", STRING, Quality.LATCHED).send(b"map")
    world.bus.run(1.5)
    for _ in range(2):
        world.offers.change("/kept", 1)
        world.bus.run(0.1)
    assert world.channels[0].messages == [b"map", b"map"]
