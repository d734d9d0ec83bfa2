"""Which physics was left out: locate it, name it, say what it did, propose what would show it."""

from softfinger.mismatch.diagnose import Diagnosis, diagnose

__all__ = ["Diagnosis", "diagnose"]
