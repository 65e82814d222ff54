"""Values of attributes: substitution, expressions, conversion and YAML, within limits."""
