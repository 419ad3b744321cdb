"""Start the predictor with a scene and the topics of one body.

ros2 launch impact_predictor predictor.launch.py params_file:=my_scene.yaml odom:=/robot/odom
"""

from launch import LaunchDescription

from impact_predictor.ros.launching import described


def generate_launch_description() -> LaunchDescription:
    return described({"odom": "Topic of the body's state.", "contact_geometry": "Topic of the body's contact points."})
