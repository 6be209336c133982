"""Inputs broken at random, in great number: whatever is handed in ends in an answer or in one line."""
