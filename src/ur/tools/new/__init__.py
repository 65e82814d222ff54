"""New launch directories, programs, bases and packages that follow the conventions of `ur check`."""
