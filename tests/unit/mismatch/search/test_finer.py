"""Finer laws of the parts of a set."""

from types import SimpleNamespace

from softfinger.mismatch.search import finer


def fitted(nats, *ids):
    return SimpleNamespace(model=SimpleNamespace(ids=set(ids)), fit=1, log_evidence=nats)


def test_the_best_of_each_part_is_tried_with_finer_laws(monkeypatch):
    arm, worse = fitted(80.0, "moment_arm"), fitted(60.0, "moment_arm")
    stop, lens = fitted(50.0, "contact_stop"), fitted(90.0, "lens_distortion")
    unfitted = fitted(99.0, "moment_arm")
    unfitted.fit = None
    for one in (arm, worse, stop, lens, unfitted):
        one.model.ids = frozenset(one.model.ids)
    top = fitted(110.0)
    top.model.ids = frozenset({"moment_arm", "contact_stop"})
    monkeypatch.setattr(finer, "list_finer", lambda part: part)
    monkeypatch.setattr(finer, "swap_forms", lambda _, part, __: [(part, "finer")])
    found = finer.fit_finer(None, top, [arm, worse, stop, lens, unfitted])
    assert sorted(part.log_evidence for part, _ in found) == [50.0, 80.0]
