"""The documents of one launch file: its arguments, nodes, includes, tree and graph."""
