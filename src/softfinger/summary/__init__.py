"""Numbers, statistics and decisions that figures and report show."""

from softfinger.summary.gather import judge_run, summarise

__all__ = ["judge_run", "summarise"]
