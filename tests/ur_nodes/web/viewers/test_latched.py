from ur_nodes.ports.node import Sender
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.viewers.advertised_topics import Latched, compare_topics


def message(data: bytes, sender: Sender | None) -> RawMessage:
    return RawMessage("a/B", "", data, sender)


def test_newest_message_of_each_latching_publisher_is_kept() -> None:
    latched = Latched()
    latched.note(message(b"old", Sender("/a", kept=True)))
    latched.note(message(b"new", Sender("/a", kept=True)))
    latched.note(message(b"b", Sender("/b", kept=True)))
    latched.note(message(b"c", Sender("/c", kept=False)))
    latched.note(message(b"d", None))
    assert sorted(latched.messages.values()) == [b"b", b"new"]


def test_messages_of_few_publishers_are_kept() -> None:
    latched = Latched()
    for number in range(100):
        latched.note(message(b"x", Sender(f"/{number}", kept=True)))
    assert len(latched.messages) == 64
    assert "/99" in latched.messages


def test_topics_are_withdrawn_and_offered_as_they_are_published() -> None:
    offered = {"/gone": "std_msgs/String", "/same": "std_msgs/Bool", "/other": "std_msgs/Bool"}
    found = [("/same", "std_msgs/Bool"), ("/other", "std_msgs/Int8"), ("/new", "std_msgs/Bool"), ("/unknown", "*")]
    gone, new = compare_topics(offered, found)
    assert sorted(gone) == ["/gone", "/other"]
    assert new == {"/other": "std_msgs/Int8", "/new": "std_msgs/Bool"}
