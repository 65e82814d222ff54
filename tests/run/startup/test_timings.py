from __future__ import annotations

from ur.run.startup.timings import begin_timings, describe_timings, read_clock


def test_timings_name_every_step_and_the_chain_to_the_last_node() -> None:
    lines = describe_timings(
        10.0,
        [("launch file", 10.25), ("master", 10.5), ("parameters", 10.75)],
        {"/slow": 11.0, "/quick": 10.75, "/never": 10.75},
        {"/slow": 13.0, "/quick": 11.0},
    )
    assert lines == [
        "start-up:",
        "     0.25 s  launch file (0.25 s)",
        "     0.50 s  master (0.25 s)",
        "     0.75 s  parameters (0.25 s)",
        "     1.00 s  /quick up, 0.25 s after its start",
        "     3.00 s  /slow up, 2.00 s after its start",
        "        -    /never never was up, started at 0.75 s",
        "  critical chain: launch file 0.25 s, master 0.25 s, parameters 0.25 s, /slow started 0.25 s, up 2.00 s: "
        "3.00 s in all",
    ]


def test_clock_is_that_of_process_starts() -> None:
    assert 0.0 < read_clock() - begin_timings().born < 3600.0
