"""Energy balance of all bodies and their exchange."""
