"""`launches.md`: the documents as one Markdown page."""
