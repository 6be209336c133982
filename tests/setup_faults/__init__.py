"""Logs with one fault of the set-up each, and without, made by no code of the program: does ``doctor`` name it?"""
