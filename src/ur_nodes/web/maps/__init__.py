"""The map in use for pages: its name, places, zones and walls, and changes of them."""
