"""The likelihood of a trial: which frames count, how their noise behaves, how trials pool."""
