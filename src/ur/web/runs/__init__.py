"""Programs and runs for the page: a client of the run protocol, and the commands that start and describe programs."""
