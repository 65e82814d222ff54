import os
import select
import signal

from ur.run.loop import ECHO, Inbox


def test_task_that_is_posted_wakes_the_loop_and_is_taken_once() -> None:
    done: list[str] = []
    inbox = Inbox(lambda _: None)
    try:
        inbox.post(lambda: done.append("task"))
        assert select.select([inbox.fileno()], [], [], 0.0)[0]
        inbox.clear()
        for task in inbox.drain():
            task()
        assert done == ["task"]
        assert not select.select([inbox.fileno()], [], [], 0.0)[0]
    finally:
        inbox.close()


def test_task_that_is_posted_after_the_end_writes_into_no_file_that_has_the_pipes_number_by_then() -> None:
    inbox = Inbox(lambda _: None)
    inbox.close()
    pipes = [os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK) for _ in range(4)]  # these take the lowest free numbers
    try:
        inbox.post(lambda: None)
        assert not select.select([reader for reader, _ in pipes], [], [], 0.0)[0]
        assert list(inbox.drain()) == []
    finally:
        for ends in pipes:
            for end in ends:
                os.close(end)


def test_signal_that_arrives_twice_at_once_is_one_request_and_later_a_second_one() -> None:
    now = 100.0
    received: list[int] = []
    inbox = Inbox(received.append, lambda: now)
    try:
        for signum in (signal.SIGINT, signal.SIGINT, signal.SIGTERM):
            signal.raise_signal(signum)
        now += ECHO
        signal.raise_signal(signal.SIGINT)
        for task in inbox.drain():
            task()
        assert received == [signal.SIGINT, signal.SIGTERM, signal.SIGINT]
    finally:
        inbox.close()
