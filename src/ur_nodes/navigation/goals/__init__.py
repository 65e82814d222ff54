"""Goals and the client that they belong to: accepted, driven to, held or cancelled by the lease."""
