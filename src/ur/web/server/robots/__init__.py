"""Several robots in one page: a separate server for each, started by the first one."""
