"""Messages of what cameras and viewers show: pictures, fiducials, clouds, markers."""
