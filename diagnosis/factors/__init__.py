"""What a sweep tells of the error factors: how well each is known, its mechanical meaning, its course over time."""
