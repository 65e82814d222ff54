"""Rules about a package: its documentation comments, the names and order of its files, and its programs."""
