"""The report's sections, one small module per question; each returns a `Section` of blocks."""
