"""The exact fast likelihood of the paper's step solution."""
