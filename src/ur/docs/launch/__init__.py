"""The documents of one launch file: its arguments, nodes, includes and tree."""
