"""What the commands do, one file each, and the files that only they share."""
