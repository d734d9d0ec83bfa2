"""Forms of effects: their columns, scores and fits."""
