"""Logs as people have them, each of one known sweep."""
