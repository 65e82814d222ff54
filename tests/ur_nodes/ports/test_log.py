from ur_nodes.ports.log import Throttle


def test_line_is_written_once_in_the_given_time_whatever_its_numbers() -> None:
    now = [10.0]
    throttle = Throttle(lambda: now[0])
    assert [throttle.lets(text, 5.0) for text in ("3.50 s ago", "3.75 s ago", "4 s ago", "4 m ago")] == [
        *(True, False, False, True)
    ]
    now[0] += 5.0
    assert throttle.lets("9.25 s ago", 5.0)


def test_line_without_a_time_is_always_written() -> None:
    throttle = Throttle(lambda: 0.0)
    assert [throttle.lets("a line", 0.0) for _ in range(3)] == [True] * 3
