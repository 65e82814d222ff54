"""Terminal interfaces that fill the screen: what `ur launch` and the programs of the nodes share."""
