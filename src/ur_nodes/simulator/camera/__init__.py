"""The camera of the simulated robot, drawn in a process of its own."""
