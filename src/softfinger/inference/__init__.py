"""One inference for every model: its likelihood, fit, evidence and sampling."""
