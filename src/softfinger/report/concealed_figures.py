"""Meanings and targets of the proof's statistics."""

# statistic → (meaning, goal, whether more is better)
STATISTICS: dict[str, tuple[str, float | None, bool]] = {
    "named": ("right name, where the oracle gains 15 nats or more", 0.95, True),
    "nameable": ("… share of those that the oracle itself could name", None, True),
    "named_nameable": ("… right name, where the oracle itself could name it", None, True),
    "named_single": ("… of a single effect", None, True),
    "named_two": ("… of two effects at once", None, True),
    "false_alarm": ("alarms on clean campaigns", 0.05, False),
    "clean_alarm": ("… other than an ambiguous answer that leaves the base model", 0.02, False),
    "strength_zero_adequate": ("effects of strength zero called adequate", None, True),
    "twin_named_without": ("right name of an effect, in campaigns without nuisances", None, True),
    "twin_named_with": ("… of the same effects with nuisances", None, True),
    "measurement_named": ("visible faults of the measurement found", 0.90, True),
    "measurement_false": ("findings about the measurement that are false", 0.05, False),
    "unlisted": ("effects from outside the catalogue called unlisted", 0.90, True),
    "recognisable": ("… share of those in which the catalogue comes not as close", None, True),
    "unlisted_recognisable": ("… called unlisted, where it comes not as close", None, True),
    "set_contains_truth": ("truth in the named or equivalent set, where masked", 0.95, True),
    "set_contains_truth_visible": ("… wherever visible", None, True),
    "buried_wrongly_named": ("below 15 nats: something claimed that is not there", None, False),
    "location_joints": ("joints right", None, True),
    "location_level": ("within or between trials right", None, True),
    "location_window": ("window since the last change of load right", None, True),
    "location_covariate": ("covariate right", None, True),
    "interval_coverage_90": ("90 % intervals of effect parameters hold the truth", 0.85, True),
    "interval_coverage_90_any_form": ("… of every parameter, whatever the form", None, True),
    "crashed": ("diagnoses that ended without a verdict", None, False),
}  # fmt: skip

FIGURES = {
    "clean_false_alarm_share_worst_condition": "Alarms on clean campaigns, worst nuisance",
    "nuisance_named_share_loss": "Right names lost to nuisances",
    "law_named_share_single": "Foreign laws: right name of a single effect",
    "law_named_share_pair": "Foreign laws: right names of a pair",
    "law_set_contains_truth_share": "Foreign laws: truth in the named or equivalent set",
    "law_false_set_share": "Foreign laws: something named that is false",
    "law_band_coverage_90": "Part of a law's recorded range that lies in its 90 % band",
}
