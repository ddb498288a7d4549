"""What holds bodies that contact does not."""
