"""One likelihood, fit, evidence and sampler for every model."""
