"""Parts of bench/scale: one module a subject, and the rows that they measure."""
