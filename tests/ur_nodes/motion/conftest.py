from typing import Any


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say what the joystick of the tests was."""
    reports = [report for kind in ("passed", "failed") for report in terminalreporter.getreports(kind)]
    for name in sorted({str(value) for each in reports for key, value in each.user_properties if key == "joystick"}):
        terminalreporter.write_line(f"joystick of the tests: {name}")
