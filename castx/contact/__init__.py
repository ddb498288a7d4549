"""Contact between bodies: one file per method."""
