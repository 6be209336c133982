"""Marks that an effect leaves beside the mean: in the values, in the spread, in single rows."""
