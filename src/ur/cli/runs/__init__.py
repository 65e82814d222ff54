"""Commands on runs: list, attach, logs, restart, stop and wait."""
