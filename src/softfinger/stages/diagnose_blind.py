"""Rule `diagnose_blind`: a process with the campaign alone."""

from pathlib import Path

from softfinger.concealed.blind import diagnose_blind as run_blind
from softfinger.concealed.blind import write_answer


def diagnose_blind(
    *,
    campaign: Path,
    diagnosis: Path,
    answer: Path,
    digest: Path,
    patience_s: float,
    mcmc: bool,
    seal: Path | None = None,
) -> None:
    """Diagnose, seal any truth, write the hashed answer."""
    if seal is not None:
        print(f"sealed before: {Path(seal).read_text(encoding='utf-8').strip()}")
    found = run_blind(Path(campaign), Path(diagnosis), patience_s, mcmc=mcmc)
    written = write_answer(found, Path(answer), Path(digest))
    print(f"answered: SHA-256 of the answer is {written}")
