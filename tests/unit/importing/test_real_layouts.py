"""Files of others as they were published: skipped where the folder with them is absent."""

import shutil

import numpy as np
import pytest

from softfinger.campaign import check_campaign
from softfinger.importing import write_campaign


def test_zwick_workbook_of_a_sheet_per_trial(real, read):
    found = read(real("wet-unit-cells/raw/wet_4and5N_20181119.xls"))
    assert len(found.trials) == 20
    first = found.trials[0]
    assert first.name == "0.65_9_5"
    assert (found.description.motion.unit, found.description.load.unit) == ("mm", "N")
    np.testing.assert_allclose(first.time[:3], [0, 0.08, 0.11], atol=1e-9)
    np.testing.assert_allclose(first.motion[7, 0], 0.010883808)
    np.testing.assert_allclose(first.load[:2], [0.112472035, 0.110661387])


def test_workbook_with_a_preamble_in_every_sheet(real, read):
    found = read(real("spruce-lr/raw/LR_samples_results.xlsx"))
    first = found.trials[0]
    assert (len(found.trials), first.name) == (34, "1-mLR2-2-10")
    np.testing.assert_allclose(first.time[:2], [0.0, 30.0])
    np.testing.assert_allclose(first.motion[3, 0], 7.907024686598912e-05)
    assert found.description.load.stated == "Creep Stress"
    np.testing.assert_allclose(first.load, [42.42749046178974])
    assert first.covariates == {"measured_mean_rh_pct": 31.0}


def test_tags_in_pixels_below_a_preamble_of_the_logger(real, read):
    found = read(real("sma-limb/raw/test_c1_only.csv"))
    (trial,) = found.trials
    assert found.description.load.column == "pwm_duty_limb0_rev"
    assert len(trial.points) == 9
    assert trial.motion.shape[1] == 18
    assert np.isnan(trial.motion[0]).all()  # lost tags are at (0, 0)
    row = int(np.flatnonzero(np.isclose(trial.time, 7.204))[0])
    np.testing.assert_allclose(trial.motion[row, :2], [34.61796247929508, 52.982685394380695])
    np.testing.assert_allclose(trial.load[row], 0.1)


def test_tab_separated_compliance_of_a_rheometer(real, read):
    (trial,) = read(real("polystyrene-175/raw/creep_ps175_data.csv")).trials
    assert trial.time.size == 3599
    np.testing.assert_allclose([trial.time[0], trial.motion[0, 0]], [0.2011, 1.49e-5])
    np.testing.assert_array_equal([trial.load_time, trial.load], [[0.0], [1.0]])


def test_two_trials_side_by_side_under_merged_headings(real, read):
    found = read(real("tdcr-tendon-staircase/RawDataT1T2.xlsx"), "clock.interval_s=0.2")
    assert [t.name for t in found.trials] == ["T1 tension and release", "T2 tension and release"]
    assert [t.time.size for t in found.trials] == [287, 316]
    first = np.arctan2(254 - 321, 562 - 609), np.arctan2(257 - 323, 558 - 606)
    np.testing.assert_allclose(np.abs(found.trials[0].motion[1, 0]), abs(first[1] - first[0]))
    assert any("second camera" in said for said in found.guessed)


def test_two_trials_side_by_side_by_prefix(real, read):
    path = real("tdcr-tendon-staircase/RawDataT1T2_flat.csv")
    found = read(path, "clock.interval_s=0.2", "motion.points.names=[R1, R2]")
    assert [(t.name, t.time.size) for t in found.trials] == [("T1", 287), ("T2", 316)]


def test_long_table_of_points(real, read):
    path = real("balloon-dots-video/tracked_points.csv")
    found = read(path, "clock.frames_per_second=29.896", "motion.points.names=['3', '0', '1']")
    (trial,) = found.trials
    assert trial.time.size == 288
    np.testing.assert_allclose(trial.time[1], 1 / 29.896)
    np.testing.assert_allclose(trial.motion[1, 2:4], [52.41925, 362.97565])


def test_distance_by_frame(real, read):
    found = read(real("balloon-dots-video/distance.csv"), "clock.frames_per_second=29.896")
    (trial,) = found.trials
    assert (found.description.motion.unit, found.description.motion.columns) == ("pixel", ("L",))
    np.testing.assert_allclose(np.abs(trial.motion[:2, 0]), [165.73775, 166.29712])


def test_hand_labels_with_semicolons(real, read):
    (trial,) = read(real("dp-dots-handlabelled/GroundTruthV1.csv")).trials
    assert trial.points == ("A", "B", "C")
    np.testing.assert_array_equal(trial.motion[2], [500, 500, 681, 629.4, 886.8, 706.9])
    np.testing.assert_allclose(trial.time[1:3], [1.5153, 2.485])


def test_angles_among_columns_of_lists(real, read):
    (trial,) = read(real("dp-dots-handlabelled/EvalOutput.csv")).trials
    np.testing.assert_allclose(np.abs(trial.motion[1]), [0.9541945578, 0.2530285743])


def test_decimal_commas_in_quotes(real, read):
    (trial,) = read(real("dp-dots-handlabelled/peer_tool_full_run.csv")).trials
    assert trial.time.size == 2116
    np.testing.assert_allclose(trial.time[:2], [0.1458, 0.4785])
    np.testing.assert_allclose(np.abs(trial.motion[22]), [0.018179815, 0.040800400], rtol=1e-6)


def test_gaps_are_kept(real, read):
    found = read(real("dp-dots-handlabelled/long_run/Misdetection.csv"))
    (trial,) = found.trials
    assert np.isnan(trial.motion).sum() > 0
    assert any("'Angle2': it is empty" in said for said in found.dropped)
    np.testing.assert_allclose(np.abs(trial.motion[0, 0]), 0.606987664)


def test_angles_and_loads_in_folders_of_their_own(real, read, tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    for folder in ("angles", "load"):
        shutil.copytree(real(f"softfinger-a/{folder}"), source / folder)
    found = read(source, "tables.files=['angles/pwm200*', 'load/pwm200*']")
    assert [t.name for t in found.trials] == [f"pwm200_old{k}" for k in range(4)]
    assert found.description.load.column == "load: command"
    np.testing.assert_array_equal(found.trials[0].load[:3], [0, 0, 200])


@pytest.mark.parametrize(
    "path", ["wet-unit-cells/raw", "spruce-lr/raw", "sma-limb/raw", "polystyrene-175/raw"]
)
def test_what_is_imported_is_a_campaign(real, read, tmp_path, path):
    found = read(real(path))
    write_campaign(tmp_path / "campaign", found.description, found.trials, found.guessed)
    assert check_campaign(tmp_path / "campaign") == {}
