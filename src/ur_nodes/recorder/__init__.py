"""Long recordings: topics are written to MCAP files for as long as the recording runs."""
