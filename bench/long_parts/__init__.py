"""Parts of bench/long: the patrol, and samples of its processes."""
