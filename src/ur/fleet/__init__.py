"""One command for several robots: a process for each, side by side, and a table of them."""
