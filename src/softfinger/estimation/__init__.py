"""Trials' parameters, the paper's way and Bayes'."""

from softfinger.estimation.diagnostics import diagnose_sampling
from softfinger.estimation.least_squares import fit_least_squares

__all__ = ["diagnose_sampling", "fit_least_squares"]
