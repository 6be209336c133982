"""Many devices, one file each: ``halltwin fleet``."""
