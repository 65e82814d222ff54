"""Messages of any type: their definitions, and their bytes as values."""
