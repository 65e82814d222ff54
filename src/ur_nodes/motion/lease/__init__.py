"""The lease of a robot, which names the client that drives: its transitions, its JSON form, and its clients."""
