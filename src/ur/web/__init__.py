"""The web page: a server on this computer that shows the robot in a browser and forwards driving commands."""
