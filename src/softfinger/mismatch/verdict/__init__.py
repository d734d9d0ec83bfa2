"""The verdict: its schema, its sentences, its figures."""
