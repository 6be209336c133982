"""What people run: one file a command, and the command line."""
