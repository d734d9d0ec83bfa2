"""The whole workflow, called from Python."""

from pathlib import Path

from softfinger.api.results import Results, open_results
from softfinger.faults import Fault


def run(
    campaign: Path | str, out: Path | str, *, config: Path | str | None = None, cores: int = 2
) -> Results:
    """Run the workflow, as ``softfinger run`` does.

    What is up to date is not made again. Call it from the main thread, for Ctrl-C to end it.

    Parameters
    ----------
    campaign : Path
        A campaign folder.
    out : Path
        Folder for the artifacts and the report; it is made.
    config : Path
        YAML file whose keys replace the defaults.
    cores : int
        Processor cores to use.

    Raises
    ------
    Fault
        The campaign or the configuration is refused, another run has the folder, or a step failed.
    """
    from softfinger.cli.campaign import run_workflow  # an effect's module need not load it
    from softfinger.cli.supervision import hold_folder

    settings = None if config is None else Path(config)
    if run_workflow(Path(campaign), hold_folder(Path(out)), settings, cores) != 0:
        raise Fault(f"a step of the run failed; its log is in {Path(out) / 'logs'}")
    return open_results(out)
