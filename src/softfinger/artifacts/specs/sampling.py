"""Whether the sampling of the posterior can be trusted."""

from softfinger.artifacts.spec import ArtifactSpec, Variable

SPEC = ArtifactSpec(
    name="sampling",
    title="Convergence of the sampling of every hyperparameter",
    rule="sampling",
    attrs=("r_hat_max", "ess_min", "divergences_max", "verdict"),
    coords={"quantity": Variable(("quantity",), "1", "hyperparameter and joint", "text")},
    variables={
        "r_hat": Variable(("quantity",), "1", "rank-normalised split R-hat", at_least=0.0),
        "ess_bulk": Variable(("quantity",), "1", "effective draws, bulk", at_least=0.0),
        "ess_tail": Variable(("quantity",), "1", "effective draws, tails", at_least=0.0),
        "divergences": Variable((), "1", "divergent transitions", "whole number"),
        "expansion_pareto_k": Variable(
            (), "1", "Pareto k of the weights by the full model", optional=True
        ),
        "expansion_error": Variable(
            (), "1", "sd of what the expansion leaves out of a trial [nats]", optional=True
        ),
    },
)
