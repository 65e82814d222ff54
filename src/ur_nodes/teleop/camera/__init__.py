"""Pictures of a camera on a terminal."""
