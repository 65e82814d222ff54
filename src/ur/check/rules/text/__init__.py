"""Rules about the text of a launch file: its XML, its tags, and comments that hide findings."""
