"""The report's figures, alternative texts and captions.

A caption states what is seen, which rule and artifact it comes from, how many trials, and which
interval. A picture whose artifact is missing is None.
"""
