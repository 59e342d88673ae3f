"""Comparing samplers in equal time, against a reference that is kept."""
