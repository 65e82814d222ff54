"""One command for several robots: a process for each, in parallel, and a table of their states."""
