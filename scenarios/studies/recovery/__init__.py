"""Ground-truth recovery: how often hidden causes are found, by strength and noise."""
