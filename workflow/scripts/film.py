"""Rule `film`."""

from softfinger.stages.film import film
from softfinger.stages.glue import run_stage

run_stage(film, snakemake)
