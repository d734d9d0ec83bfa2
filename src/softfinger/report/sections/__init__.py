"""The report's sections, one small module per question.

Each returns a `Section` of blocks.
"""
