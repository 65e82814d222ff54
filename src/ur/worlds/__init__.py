"""World files and floor plans of the simulator: read, validated, and made from pictures."""
