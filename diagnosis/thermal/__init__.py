"""The error factors over temperature: readings of one sensor at several, and the law of each factor."""
