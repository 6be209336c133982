"""The tables that drives and sensors load, one kind a file: fitted, written, read back by the drive's arithmetic."""
