"""What stands between a commander and the wheels: who may drive, how fast, and when to stop. Joysticks, too."""
