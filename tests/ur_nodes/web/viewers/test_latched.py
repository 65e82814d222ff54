from __future__ import annotations

from ur_nodes.web.viewers.latched import Latched, compare_topics


def test_newest_message_of_each_latching_publisher_is_kept() -> None:
    latched = Latched()
    latched.note({"latching": "1", "callerid": "/a"}, b"old")
    latched.note({"latching": "1", "callerid": "/a"}, b"new")
    latched.note({"latching": "1", "callerid": "/b"}, b"b")
    latched.note({"latching": "0", "callerid": "/c"}, b"c")
    latched.note({}, b"d")
    assert sorted(latched.messages.values()) == [b"b", b"new"]


def test_messages_of_few_publishers_are_kept() -> None:
    latched = Latched()
    for number in range(100):
        latched.note({"latching": "1", "callerid": f"/{number}"}, b"x")
    assert len(latched.messages) == 64
    assert "/99" in latched.messages


def test_topics_are_withdrawn_and_offered_as_they_are_published() -> None:
    offered = {"/gone": "std_msgs/String", "/same": "std_msgs/Bool", "/other": "std_msgs/Bool"}
    found = [("/same", "std_msgs/Bool"), ("/other", "std_msgs/Int8"), ("/new", "std_msgs/Bool"), ("/unknown", "*")]
    gone, new = compare_topics(offered, found)
    assert sorted(gone) == ["/gone", "/other"]
    assert new == {"/other": "std_msgs/Int8", "/new": "std_msgs/Bool"}
