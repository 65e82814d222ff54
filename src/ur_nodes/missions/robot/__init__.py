"""The node of the robot that drives a mission: its state machine, the requests that it accepts, and its topics."""
