import subprocess
import sys


def test_importing_mechanics_compiles_nothing_and_pulls_in_no_stage():
    code = (
        "import sys, softfinger.mechanics.forward.simulate, softfinger.mechanics.dynamics\n"
        "from softfinger.mechanics.forward.trials import run_trials\n"
        "assert not run_trials.signatures\n"
        "own = {m.split('.')[1] for m in sys.modules if m.startswith('softfinger.')}\n"
        "assert own == {'compiled', 'mechanics', 'faults'}, own\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
