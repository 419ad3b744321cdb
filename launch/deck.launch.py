"""Start the predictor for the cargo on a moving deck: a shipped scene by its name, or any other by its file.

ros2 launch impact_predictor deck.launch.py scene:=deck_many support_odom:=/deck/odom
ros2 launch impact_predictor deck.launch.py params_file:=my_deck.yaml namespace:=ship
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

INPUTS = {
    "support/odom": "Topic of the deck's state.",
    "support/imu": "Topic of an inertial sensor on the deck.",
}


def generate_launch_description() -> LaunchDescription:
    scene = PathJoinSubstitution([FindPackageShare("impact_predictor"), "config", LaunchConfiguration("scene")])
    return LaunchDescription(
        [
            DeclareLaunchArgument("scene", default_value="deck_crate", description="Name of a shipped scene."),
            DeclareLaunchArgument(
                "params_file", default_value=[scene, ".yaml"], description="ROS 2 parameter file of a scene."
            ),
            DeclareLaunchArgument(
                "namespace", default_value="", description="Namespace of the node and of the topics of deck and cargo."
            ),
            *[
                DeclareLaunchArgument(name.replace("/", "_"), default_value=name, description=text)
                for name, text in INPUTS.items()
            ],
            Node(
                package="impact_predictor",
                executable="predictor",
                name="impact_predictor",
                namespace=LaunchConfiguration("namespace"),
                output="screen",
                parameters=[LaunchConfiguration("params_file")],
                remappings=[(name, LaunchConfiguration(name.replace("/", "_"))) for name in INPUTS],
            ),
        ]
    )
