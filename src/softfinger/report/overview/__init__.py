"""The report's first layer, one small module per question.

The head of a lab reads it in two minutes. Each module returns a `Section`, whose `more` names the
parts of the second layer that it relies on.
"""
