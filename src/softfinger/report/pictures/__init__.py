"""Every figure of the report, with its alternative text and its caption.

A caption says what is seen, which rule and artifact it comes from, how many trials, and which
interval. A picture whose artifact is missing is None.
"""
