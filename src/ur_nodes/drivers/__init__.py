"""What upstream's drivers of real bases leave out, added to what they publish."""
