"""Find and name the physics that was left out."""

from softfinger.mismatch.diagnose import Diagnosis, diagnose
from softfinger.mismatch.tables.outcome import describe_repair, tabulate_diagnosis
from softfinger.mismatch.verdict.schema import read_verdict, write_verdict

__all__ = [
    "Diagnosis",
    "describe_repair",
    "diagnose",
    "read_verdict",
    "tabulate_diagnosis",
    "write_verdict",
]
