"""The camera of the simulated robot, rendered in a separate process."""
