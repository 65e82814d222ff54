"""Several robots in one page: a server of its own for each, started by the first one."""
