"""Running a plan: start, supervise, stop."""
