import numpy as np

from softfinger.tracking.body import Body

HOME = np.array([[10.0, 50.0], [30.0, 50.0], [45.0, 50.0], [70.0, 50.0]])
RADIUS = np.full(4, 4.0)


def build():
    joint, arm = np.array([5.0, np.nan]), np.array([np.nan, np.nan, 10.0, 35.0])
    return Body.measure([[0, 1], [2, 3]], HOME, joint, arm)


def recover(position, discs, predicted=HOME, lost=1, body=None):
    lost_for = np.where(np.isnan(position[:, 0]), lost, 0)
    return (body or build()).recover(position, predicted, RADIUS, lost_for, np.array(discs))


def lose(*markers):
    position = HOME.copy()
    position[list(markers)] = np.nan
    return position


def test_a_lost_marker_is_the_disc_at_the_right_distance_from_its_mate():
    discs = [*HOME[:3], [60.0, 52.0], [69.0, 53.0]]
    assert recover(lose(3), discs) == {3: 4}


def test_nothing_is_taken_where_no_disc_fits():
    assert recover(lose(3), [*HOME[:3], [60.0, 52.0]]) == {}
    assert recover(lose(3), np.empty((0, 2))) == {}


def test_a_disc_that_is_another_marker_already_is_not_taken_twice():
    near_mate = HOME.copy()
    near_mate[3] = HOME[2] + [0.0, 1.0]
    assert recover(lose(3), HOME[:3], predicted=near_mate) == {}


def test_a_whole_link_lost_is_named_by_the_joint_before_it():
    # The link swung back; both orders keep the distance, but only one starts at the joint (35, 50).
    far, near = [35.0 - 35.0 * 0.6, 50.0 - 35.0 * 0.8], [35.0 - 10.0 * 0.6, 50.0 - 10.0 * 0.8]
    predicted = HOME.copy()
    predicted[2:] = [[20.0, 35.0], [20.0, 35.0]]
    assert recover(lose(2, 3), [far, near], predicted=predicted) == {2: 1, 3: 0}


def test_a_lone_marker_is_looked_for_nearby_only():
    body = Body.measure([[0], [1], [2], [3]], HOME)
    assert recover(lose(3), [*HOME[:3], [78.0, 50.0]], body=body) == {3: 3}
    assert recover(lose(3), [*HOME[:3], [99.0, 50.0]], body=body) == {}


def test_both_ends_of_a_stretched_distance_are_doubted():
    moved = HOME.copy()
    moved[2] += [3.0, 0.0]
    np.testing.assert_array_equal(build().find_stretched(moved, RADIUS), [False, False, True, True])
    assert not build().find_stretched(lose(2), RADIUS).any()


def test_distances_follow_a_lens_slowly():
    body = build()
    grown = HOME.copy()
    for _ in range(120):
        grown[3] += [0.05, 0.0]
        assert not body.find_stretched(grown, RADIUS).any()
        body.adapt(grown)
    body.adapt(lose(3))
    np.testing.assert_allclose(body.distance, [20.0, 30.0], atol=1.2)
    assert body.find_stretched(HOME, RADIUS)[2:].all()
