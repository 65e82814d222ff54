from bench.mapping_parts.summary import Drive, summarise


def test_median_beyond_its_limit_is_marked_whichever_direction_is_better() -> None:
    drives = [Drive("maze", {"final m": final, "F": f}) for final, f in ((0.004, 0.99), (0.007, 0.85), (0.008, 0.80))]
    lines = summarise(drives)
    assert lines[0] == "maze, 3 drives:"
    assert "median    0.007  worst    0.008  limit 0.006  MISSED" in lines[1]
    assert "median     0.85  worst      0.8  limit 0.9  MISSED" in lines[2]


def test_worst_drive_alone_misses_nothing() -> None:
    assert not any("MISSED" in line for line in summarise([Drive("lab", {"F": f}) for f in (0.99, 0.95, 0.5)]))


def test_drives_of_different_sensors_are_not_mixed() -> None:
    drives = [Drive("office", {"F": 0.9}), Drive("office, poor sensors", {"F": 0.8})]
    assert [line for line in summarise(drives) if line.endswith(":")] == [
        "office, 1 drives:",
        "office, poor sensors, 1 drives:",
    ]
