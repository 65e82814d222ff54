"""Contents of the page as frames: layers over the map, the camera, and numbers to plot."""
