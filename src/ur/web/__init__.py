"""The page: a server on this computer that shows the robot in a browser and passes on what drives it."""
