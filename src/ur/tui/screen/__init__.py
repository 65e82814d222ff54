"""Full-screen terminal interfaces: modules shared by `ur launch` and the programs of the nodes."""
