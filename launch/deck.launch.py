"""Start the predictor for the cargo on a moving deck: a shipped scene by its name, or any other by its file.

ros2 launch impact_predictor deck.launch.py scene:=deck_many support_odom:=/deck/odom
ros2 launch impact_predictor deck.launch.py params_file:=my_deck.yaml namespace:=ship
"""

from launch import LaunchDescription

from impact_predictor.ros.launching import described


def generate_launch_description() -> LaunchDescription:
    inputs = {"support/odom": "Topic of the deck's state.", "support/imu": "Topic of an inertial sensor on the deck."}
    return described(inputs, scene="deck_crate")
