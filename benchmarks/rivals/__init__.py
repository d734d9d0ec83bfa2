"""Rivals at their best, one file each.

They get the same information, start values and windows as we, and a compiled inner loop. Beside
every time is an accuracy, and the best of several rivals counts.
"""
