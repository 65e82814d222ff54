"""A launch file resolved in every case: per base, variant and option."""
