"""What further effects explain of the rest, where none is named.

A free-form term gains more than they do, or more of them are needed than a verdict names. So they
are no finding. But they are the best that the catalogue can do, and a verdict has them as that.
"""

from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.search.demand import Demand
from softfinger.mismatch.search.eliminate import choose_top
from softfinger.mismatch.search.extend import Task, extend
from softfinger.mismatch.search.stepwise import Search


def go_beyond(task: Task, search: Search, demand: Demand) -> Search:
    """Add effects to the best set while each gains enough.

    The larger sets are the search's `beyond`; all else is as it was.
    """
    known = task.base
    top, larger = choose_top([search.best, *search.candidates], search.best), []
    for _ in range(BUDGET.beyond):
        gain = top.log_evidence - known.log_evidence
        asked = top.log_evidence + demand.ask(top.model.ids - known.model.ids, gain)
        more = choose_top(extend(task, top, task.pieces, asked), top)
        if more.log_evidence <= asked:
            break
        larger.append(top := more)
    return search._replace(beyond=tuple(larger))
