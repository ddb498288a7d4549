"""Contact methods, one file each."""
