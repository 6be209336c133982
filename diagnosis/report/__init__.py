"""The answer to a sweep as JSON, on the terminal, and as a page with pictures."""
