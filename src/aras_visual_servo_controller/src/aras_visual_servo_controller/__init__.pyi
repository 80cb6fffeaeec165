# The public API of the ROS side.
from .bags.bag import read_bag as read_bag
from .bags.files import BagFiles as BagFiles
from .bags.record_groups import parse_groups as parse_groups
from .bags.replay import replay as replay
from .calibration.camera import calibrate_camera as calibrate_camera
from .calibration.hand_eye import calibrate_hand_eye as calibrate_hand_eye
from .calibration.joint_offsets import calibrate_joint_offsets as calibrate_joint_offsets
from .calibration.target import target_plane as target_plane
from .identification.efforts import identify_efforts as identify_efforts
from .identification.loops import identify_loops as identify_loops
from .identification.recording import Commands as Commands
from .identification.recording import Recording as Recording
from .identification.twin import Twin as Twin
from .identification.twin import identify_twin as identify_twin
from .nodes.graph import Graph as Graph
from .nodes.launch import run_over_ros as run_over_ros

# For packages built on this one
from .ros2.wire import definitions_of as definitions_of
from .ros2.wire import to_cdr as to_cdr
from .nodes.calls import call_service as call_service
from .nodes.conversions import JointReader as JointReader
from .nodes.conversions import LazyJointState as LazyJointState
from .nodes.conversions import goal_message as goal_message
from .nodes.conversions import stamp_ns as stamp_ns
from .nodes.conversions import to_time as to_time
