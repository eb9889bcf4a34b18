"""Fits of a scenario's numbers to measurements: how sure they are, and which test tells more."""
