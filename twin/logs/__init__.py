"""Logs that are no sweep files of the project: any dialect, names and units, read into the columns of a sweep."""
