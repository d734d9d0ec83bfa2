"""Find and name the physics that was left out."""

from softfinger.artifacts.verdict import read_verdict, write_verdict
from softfinger.mismatch.diagnose import Diagnosis, diagnose
from softfinger.mismatch.tables.outcome import describe_repair, tabulate_diagnosis

__all__ = [
    "Diagnosis",
    "describe_repair",
    "diagnose",
    "read_verdict",
    "tabulate_diagnosis",
    "write_verdict",
]
