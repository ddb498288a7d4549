"""What the user asks for: the case as frozen, validated descriptions."""
