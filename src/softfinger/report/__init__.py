"""The report: artifacts → one self-contained HTML page, and figures for publication."""

from softfinger.report.page import write_report

__all__ = ["write_report"]
