"""The mux and its lease, as programs for people see them."""
