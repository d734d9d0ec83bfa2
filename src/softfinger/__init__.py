"""Which physics a wire-driven soft finger's model leaves out.

A Bayesian workflow: raw rig videos → posterior of the viscoelastic parameters → left-out physics.
"""
