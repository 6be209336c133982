"""Discovery: the stages by which a sweep is held against the twin, and what the twin lacks is named and proven."""
