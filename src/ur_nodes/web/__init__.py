"""The robot's end of the page: frames to look at, and requests of pages checked and passed on to mux and navigation."""
