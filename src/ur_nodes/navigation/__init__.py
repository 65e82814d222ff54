"""Global and local planning, recovery and goals: the stand-in for `move_base`."""
