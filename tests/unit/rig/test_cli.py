import pytest

from softfinger.faults import Fault
from softfinger.rig.cli import record


@pytest.mark.parametrize("text", ["temperature_c", "temperature_c=warm", "load=3", "a b=3", "=3"])
def test_an_environment_that_is_no_column_is_refused_before_anything_is_opened(text, tmp_path):
    with pytest.raises(Fault, match="expected column=number"):
        record(tmp_path / "absent.yaml", tmp_path / "c", "/dev/absent", "0", [text])
