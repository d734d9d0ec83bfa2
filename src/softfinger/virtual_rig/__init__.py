"""An instrument simulator: draws a finger, moves it, films it, writes a campaign folder.

Nothing downstream can tell its campaigns from measured ones, except by ``source: synthetic``.
"""
