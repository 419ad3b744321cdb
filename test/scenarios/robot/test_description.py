"""What of a foot touches the ground."""

from impact_predictor.scenarios.robot.description import Sole


def test_a_flat_sole_touches_with_heel_and_toe_and_a_ball_below_its_centre() -> None:
    assert Sole(heel=-0.1, toe=0.15, width=0.08).points.tolist() == [[-0.1, 0.0, 0.0], [0.15, 0.0, 0.0]]
    assert Sole(radius=0.03).points.tolist() == [[0.0, 0.0, 0.0]]
