"""Start the predictor for a walking machine, with the topics of its trunk and of its feet.

ros2 launch impact_predictor walker.launch.py odom:=/robot/odom contact_geometry:=/robot/feet
ros2 launch impact_predictor walker.launch.py params_file:=my_robot.yaml joint_states:=/robot/joint_states
"""

from launch import LaunchDescription

from impact_predictor.ros.launching import described

INPUTS = {
    "odom": "Topic of the trunk's state.",
    "contact_geometry": "Topic of the feet's points in the trunk's frame, for a machine without robot.urdf.",
    "feet_states": "Topic of the feet's points by their names, with velocities and forces, in its place.",
    "joint_states": "Topic of the joints, for a machine with robot.urdf.",
    "contact_wrench": "Topic of the forces at the feet, where feet.force is above 0.",
    "schedule": "Topic of the planned contacts, where feet.has_schedule is true.",
    "terrain": "Topic of the heights of the ground, where feet.terrain is above 0.",
}


def generate_launch_description() -> LaunchDescription:
    return described(INPUTS, scene="walker")
