"""The report, a self-contained page, and publication figures.

Both are made from artifacts.
"""

from softfinger.report.page import write_report

__all__ = ["write_report"]
