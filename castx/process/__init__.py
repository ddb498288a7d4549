"""Steps, stages and cycles of a casting process."""
