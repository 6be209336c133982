"""Generalised least squares of the whole chain: observations, linearised chain, noise, joint fit."""
