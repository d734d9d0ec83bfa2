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

    None has more than a search tries. The larger sets are its `beyond`; all else is as it was.
    """
    known = task.base
    top, larger = choose_top([search.best, *search.candidates], search.best), []
    few = BUDGET.most_effects - len(top.model.ids - known.model.ids)
    for _ in range(min(BUDGET.beyond, few)):
        gain = top.log_evidence - known.log_evidence
        asked = top.log_evidence + demand.ask(top.model.ids - known.model.ids, gain)
        more = choose_top(extend(task, top, task.pieces, asked), top)
        if more.log_evidence <= asked:
            break
        larger.append(top := more)
    return search._replace(beyond=tuple(larger))
