"""The pure core of a run: states of nodes, events, requests, and the actions that follow."""
