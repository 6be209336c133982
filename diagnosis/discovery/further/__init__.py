"""Further measurements: what to record next, and how well it would part the causes that one sweep cannot."""
