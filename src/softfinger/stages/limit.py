"""Rule `limit`: what the oracle could name, afterwards."""

import json
from pathlib import Path

from softfinger.concealed.limit import weigh_stand_ins
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def limit(*, truth: Path, limit: Path) -> None:
    """Write what `weigh_stand_ins` finds."""
    weighed = weigh_stand_ins(json.loads(Path(truth).read_text(encoding="utf-8")))
    Path(limit).write_text(json.dumps(weighed, indent=1, sort_keys=True) + "\n", encoding="utf-8")
