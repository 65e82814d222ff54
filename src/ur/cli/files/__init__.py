"""Commands on launch files and packages: check, format, find, explain, docs, graph, package and new."""
