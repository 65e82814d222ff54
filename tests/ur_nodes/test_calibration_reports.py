import json
from pathlib import Path

import pytest

from ur.devices.driver_health import MotionRecord, health_file, parse_drivers, parse_records
from ur_nodes.calibration_reports import CalibrationReports
from ur_nodes.geometry.calibration import CalibrationFigures, Errors
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.data.diagnostics import KIND

SPREAD = Errors(0.001, 0.001, 0.001, 0.001, 0.002)
TEXT = "the lidar is turned by 2.9 degrees to the left; the wheels are 4.8 % smaller than described"


def test_errors_are_in_the_log_once_in_diagnostics_and_in_a_file_while_the_node_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    bus = Bus()
    bus.schemas[KIND] = "DiagnosticStatus[] status"
    node, shown = bus.node("amcl"), list[RawMessage]()
    bus.node("page").raw.subscribe("/diagnostics", shown.append, Quality.EVERY)
    reports, file = CalibrationReports(node), health_file("/amcl.calibration")
    bus.run(11.0)
    assert shown == []
    reports.figures = CalibrationFigures(21.0, Errors(0.05, 0.001, 0.002, -0.048, 0.003), SPREAD)
    bus.run(11.0)
    assert [text for _, text in node.lines] == [f"{TEXT}; help: ur robot calibrate"]
    (status,) = json.loads(shown[-1].data)["status"]
    assert (status["level"], status["message"]) == (1, f"{TEXT}; ur robot calibrate")
    assert {"key": "lidar yaw", "value": "2.86 +- 0.06 degrees"} in status["values"]
    assert {"key": "wheel separation", "value": "+0.30 +- 0.20 %"} in status["values"]
    record = MotionRecord(21.0, 0.05, 0.0, 0.0, -0.048, 0.0)
    assert parse_records(f"1 {file.read_text()}", MotionRecord) == (record,)
    assert parse_drivers(f"1 {file.read_text()}") == ()
    node.end("its user ended it")
    assert not file.exists()
