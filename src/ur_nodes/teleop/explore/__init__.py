"""The program `explore_progress`: an exploration as seen by the person at the terminal."""
