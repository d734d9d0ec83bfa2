"""Viscoelastic joints as a small algebra.

Springs, dashpots and springpots, in series and in parallel.

`elements` builds networks and names the known ones, `response` is what they do; `prony` is exact
for springs and dashpots, `laplace` for everything with a springpot.
"""
