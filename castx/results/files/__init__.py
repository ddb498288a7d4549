"""Folders, tables and fields on disk."""
