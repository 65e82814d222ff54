"""The record of locks, threads and lines of nodes, which may only fall."""

from __future__ import annotations

from tools.measure_nodes import (
    NODES,
    RECORD,
    Wiring,
    count_threads,
    find_risen,
    lower,
    measure,
    read_record,
    write_record,
)

LOW, HIGH = Wiring(1, 20), Wiring(2, 30)


def test_nodes_make_no_more_locks_and_threads_and_are_no_longer_than_recorded() -> None:
    risen = find_risen(read_record(RECORD.read_text(encoding="utf-8")), measure(NODES.rglob("*.py"), NODES))
    help_ = (
        "move logic out of the node, time and threads behind a port; where code moved: tools/measure_nodes.py --write"
    )
    assert not risen, "\n".join([*risen, f"help: {help_}"])


def test_whatever_makes_a_lock_or_thread_counts_but_annotations_do_not() -> None:
    assert count_threads("import threading\nlock: threading.Lock = threading.Lock()\n") == 1
    assert count_threads("import threading\nfield(default_factory=threading.Event)\n") == 1
    assert count_threads("from queue import SimpleQueue as Q\ndef f(q: Q) -> Q:\n    return Q()\n") == 1
    assert count_threads("import threading\nclass Worker(threading.Thread): ...\n") == 1
    assert count_threads("import threading\nthreading.current_thread()\n") == 0


def test_file_above_its_record_is_named_with_both_figures() -> None:
    assert find_risen({"a.py": HIGH}, {"a.py": LOW}) == []
    (line,) = find_risen({"a.py": LOW}, {"a.py": HIGH})
    assert line == "a.py makes 2 locks and threads and has 30 lines above 80, expected at most 1 and 20"
    assert find_risen({}, {"new.py": Wiring(1, 0)})


def test_record_is_lowered_and_never_raised() -> None:
    assert lower({"a.py": HIGH, "gone.py": LOW}, {"a.py": Wiring(1, 40)}) == {"a.py": Wiring(1, 30)}


def test_code_may_move_to_a_new_file_but_not_grow_there() -> None:
    assert lower({"a.py": HIGH}, {"a.py": LOW, "b.py": Wiring(1, 10)}) == {"a.py": LOW, "b.py": Wiring(1, 10)}
    assert lower({"a.py": HIGH}, {"a.py": LOW, "b.py": HIGH}) == {"a.py": LOW}


def test_lines_that_a_merge_doubled_are_read_as_the_lowest() -> None:
    merged = write_record({"a.py": HIGH, "b.py": LOW}) + "a.py\t1\t35\nb.py\t0\t25\n"
    assert read_record(merged) == {"a.py": Wiring(1, 30), "b.py": Wiring(0, 20)}
