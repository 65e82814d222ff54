from ur_nodes.memory.bus import Bus
from ur_nodes.ports.newest_work import NewestWork


def test_of_requests_that_wait_only_the_newest_is_worked_on() -> None:
    bus = Bus()
    got: list[tuple[int, int]] = []
    done: list[int] = []

    def square(value: int) -> int:
        done.append(value)
        return value * value

    work = NewestWork(bus.node("node"), "squares", square, lambda value, result: got.append((value, result)))
    for number in (1, 2, 3):
        work.ask(number)
    bus.run(0.1)
    assert done == [1, 3]
    assert got == [(1, 1), (3, 9)]
    work.ask(4)
    bus.run(0.1)
    assert got[-1] == (4, 16)
    work.ask(5)
    work.ask(6)
    work.drop()
    bus.run(0.1)
    assert got[-1] == (4, 16)
    work.ask(7)
    bus.run(0.1)
    assert got[-1] == (7, 49)
