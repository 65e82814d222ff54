"""A report of a run: what happened, as one archive that can be given away."""
