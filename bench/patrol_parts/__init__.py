"""Parts of `bench/patrol`."""
