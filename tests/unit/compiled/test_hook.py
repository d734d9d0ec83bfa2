"""Functions called by address are compiled alone, and so are their callers."""

import importlib
import sys

import numpy as np
import pytest
from numba import types

from softfinger.compiled import compiled, digest_function
from softfinger.compiled.hook import build_call, find_address

ROW = types.Array(types.float64, 1, "C")
SIGNATURE = types.float64(ROW, types.int64)
call = build_call(SIGNATURE)
call_with_one_more = build_call(types.float64(ROW, types.int64, types.float64))


@compiled
def double(row, k):
    return 2.0 * row[k]


@compiled
def refuse(row, k):
    if row[k] > 1.0:
        raise ValueError("too large")
    return 0.0


@compiled
def total(addresses, row):
    found = 0.0
    for k in range(addresses.size):
        found += call(addresses[k], row, k)
    return found


def test_compiled_code_calls_by_address_and_hears_of_errors():
    both = np.array([find_address(double, SIGNATURE), find_address(refuse, SIGNATURE)])
    assert total(both, np.array([4.0, 1.0])) == 8.0
    with pytest.raises(ValueError, match="too large"):
        total(both, np.array([4.0, 1.5]))


def test_the_digest_of_a_caller_follows_the_signature_and_no_function():
    def caller(by):
        namespace = {"by": by}
        exec("def run(address, row):\n    return by(address, row, 0)", namespace)
        namespace["run"].__module__ = __name__
        return digest_function(namespace["run"])

    assert caller(call) == caller(build_call(SIGNATURE))
    assert caller(call) != caller(call_with_one_more)


def test_an_edited_function_is_compiled_alone(tmp_path, monkeypatch):
    hook = "from softfinger.compiled import compiled\n@compiled\ndef act(row, k):\n    return {}\n"
    file = tmp_path / "hook_of_a_plug_in.py"
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # an edit within a second would be missed
    row = np.array([3.0])
    for expression, value in {"row[k]": 3.0, "row[k] + 1.0": 4.0}.items():
        file.write_text(hook.format(expression))
        sys.modules.pop("hook_of_a_plug_in", None)
        importlib.invalidate_caches()
        act = importlib.import_module("hook_of_a_plug_in").act
        before = sum(total.stats.cache_misses.values())
        assert total(np.array([find_address(act, SIGNATURE)]), row) == value
        assert sum(act.stats.cache_misses.values()) == 1
        if value > 3.0:
            assert sum(total.stats.cache_misses.values()) == before
    sys.modules.pop("hook_of_a_plug_in")
