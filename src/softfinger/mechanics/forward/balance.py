"""The torque that statics asks of a joint.

It is the wire's pull, less what that loses, and what adds to it.

Each hook changes the value in `Balance`, its derivatives by joint angle, velocity, acceleration,
wire direction and load, and, where tangents are wanted, its change along each column at fixed
angles.
"""

from softfinger.compiled import compiled
from softfinger.mechanics.forward.hooks import BALANCE, PULL, call_balance, call_pull
from softfinger.mechanics.forward.work import Balance, Model, Nodes


@compiled
def fill_balance(model: Model, nodes: Nodes, balance: Balance, i: int, tangents: bool) -> None:
    """Write the balance of node i, in place."""
    balance.torque[i] = nodes.load[i]
    balance.by_load[i] = 1.0
    balance.by_angle[i] = 0.0
    balance.by_direction[i] = 0.0
    if model.inertial:
        balance.by_velocity[i], balance.by_acceleration[i] = 0.0, 0.0
    balance.tangent[i] = 0.0
    for k in range(model.count[PULL]):
        call_pull(model.hook[PULL, k], model, nodes, balance, i, tangents)
    for k in range(model.count[BALANCE]):
        call_balance(model.hook[BALANCE, k], model, nodes, balance, i, tangents)
