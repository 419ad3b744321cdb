"""Messages of ROS 2 as bytes, both ways: samples and geometry in, predictions, scores and reports out.

The node takes and publishes these bytes as they are and a bag holds them as they are, so both give the same.
"""

from ..cdr import Diagnostic as Diagnostic
from ..cdr import MalformedMessage as MalformedMessage
from ..cdr import decode_diagnostic_array as decode_diagnostic_array
from .inputs import IMU as IMU
from .inputs import INPUT_TYPES as INPUT_TYPES
from .inputs import JOINT_STATE as JOINT_STATE
from .inputs import JOINT_TRAJECTORY as JOINT_TRAJECTORY
from .inputs import MULTI_DOF_JOINT_STATE as MULTI_DOF_JOINT_STATE
from .inputs import ODOMETRY as ODOMETRY
from .inputs import POINT_CLOUD as POINT_CLOUD
from .inputs import POLYGON as POLYGON
from .inputs import WRENCH as WRENCH
from .inputs import decode_feet as decode_feet
from .inputs import decode_imu as decode_imu
from .inputs import decode_joints as decode_joints
from .inputs import decode_odometry as decode_odometry
from .inputs import decode_polygon as decode_polygon
from .inputs import decode_schedule as decode_schedule
from .inputs import decode_terrain as decode_terrain
from .inputs import decode_transforms as decode_transforms
from .inputs import decode_wrench as decode_wrench
from .inputs import encode_imu as encode_imu
from .inputs import encode_odometry as encode_odometry
from .inputs import encode_polygon as encode_polygon
from .outputs import DIAGNOSTIC_ARRAY as DIAGNOSTIC_ARRAY
from .outputs import MARKER_ARRAY as MARKER_ARRAY
from .outputs import OUTPUTS as OUTPUTS
from .outputs import UINT8 as UINT8
from .outputs import Output as Output
from .outputs import encode_mode as encode_mode
from .outputs import encode_post_impact as encode_post_impact
from .outputs import encode_prediction as encode_prediction
from .outputs import encode_reports as encode_reports
from .outputs import encode_score as encode_score
from .outputs import is_typed as is_typed
from .outputs import outputs_of as outputs_of
