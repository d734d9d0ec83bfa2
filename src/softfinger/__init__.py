"""Bayesian workflow for wire-driven soft fingers, from raw rig videos to left-out physics."""
