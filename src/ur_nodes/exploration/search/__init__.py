"""Search on a map that grows: frontiers, how much floor they hide, the places to see them from, and their order."""
