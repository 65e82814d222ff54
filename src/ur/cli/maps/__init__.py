"""Commands about stored maps."""
