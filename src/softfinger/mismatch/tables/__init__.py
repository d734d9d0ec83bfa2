"""Artifacts of a diagnosis."""
