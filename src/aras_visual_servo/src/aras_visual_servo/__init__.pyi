# The public API. Names that are not here may change without notice.

__version__: str

# Scenarios and runs
from .config.files import scenario_names as scenario_names
from .scenario.scenario import Scenario as Scenario
from .scenario.scenario import load_scenario as load_scenario
from .scenario.scenario import scenario_from_dict as scenario_from_dict
from .runs.judge import Judgement as Judgement
from .runs.judge import judge as judge
from .runs.cell import SimulatedCell as SimulatedCell
from .runs.cell import simulation_of as simulation_of
from .runs.judge import run as run
from .runs.loop import ServoLoop as ServoLoop
from .runs.record import RunRecord as RunRecord
from .runs.rows import RowCheck as RowCheck
from .runs.rows import check_rows as check_rows
from .studies import benchmark as benchmark
from .studies import compare as compare
from .studies import save_results as save_results
from .studies import sweep as sweep

# Laws, features and sources of one's own
from .config.settings import setting as setting
from .features.base import Feature as Feature
from .features.base import FeatureSet as FeatureSet
from .features.base import View as View
from .features.base import known_features as known_features
from .features.base import register_family as register_family
from .features.base import register_feature as register_feature
from .features.sources.base import Source as Source
from .features.sources.base import Taught as Taught
from .features.sources.base import register_source as register_source
from .laws.base import Law as Law
from .laws.base import known_laws as known_laws
from .laws.base import register_law as register_law
from .laws.base import sampled_gains as sampled_gains
from .laws.look import Answer as Answer
from .laws.look import Look as Look

# The servo, for programs that bring images and joints of their own
from .arm.kinematics import Kinematics as Kinematics
from .arm.kinematics import RobotKinematics as RobotKinematics
from .arm.robot import kinematics_of as kinematics_of
from .arm.robot import robot_kinematics as robot_kinematics
from .ground.types import Command as Command
from .ground.types import Features as Features
from .ground.types import Observation as Observation
from .ground.types import Reference as Reference
from .ground.types import ServoRecord as ServoRecord
from .ground.types import Status as Status
from .servo.servo import Servo as Servo
from .servo.settings import ServoSettings as ServoSettings
from .servo.stage import Stage as Stage
from .servo.stage import Tick as Tick
from .servo.stage import register_stage as register_stage

# Modules: poses and rotations; signals and child processes; colours
from . import cli as cli
from . import palette as palette
from . import processes as processes
from . import spatial as spatial

# Errors
from .ground.errors import ArasError as ArasError
from .ground.errors import DegenerateFeature as DegenerateFeature
from .ground.errors import ModelError as ModelError
from .ground.errors import NotFiniteError as NotFiniteError
from .ground.errors import ParameterError as ParameterError
from .ground.errors import ShapeError as ShapeError

# For packages built on this one
from .arm.home import least_singular_value as least_singular_value
from .arm.limits import accelerated as accelerated
from .arm.limits import position_factor as position_factor
from .arm.limits import velocity_factor as velocity_factor
from .arm.reach import reach as reach
from .arm.real import SetPoint as SetPoint
from .arm.real import make_form as make_form
from .arm.real import RealSettings as RealSettings
from .arm.redundancy import TwistInverse as TwistInverse
from .arm.urdf_check import MOST_TURN_RAD as MOST_TURN_RAD
from .arm.urdf_check import root_link as root_link
from .config.files import load_yaml as load_yaml
from .config.files import package_path as package_path
from .config.files import package_paths as package_paths
from .config.files import resolve_uri as resolve_uri
from .config.files import share_dir as share_dir
from .config.plugins import load_plugins as load_plugins
from .config.plugins import code_place as code_place
from .config.reader import Names as Names
from .config.validate import is_number as is_number
from .config.reader import read as read
from .config.schema import yaml_section as yaml_section
from .config.settings import keys_of as keys_of
from .features.base import expand as expand
from .features.base import feature_class as feature_class
from .features.base import spread as spread
from .features.interaction import plane_from_pose as plane_from_pose
from .features.sources.base import known_sources as known_sources
from .features.sources.base import source_named as source_named
from .features.style import styles as styles
from .features.target.outline import Outline as Outline
from .features.target.target_pose import ORDER as ORDER
from .features.target.target_pose import PlanarTarget as PlanarTarget
from .ground.extras import extra as extra
from .ground.images import eight_bit as eight_bit
from .ground.images import image_of as image_of
from .ground.registry import Registry as Registry
from .ground.images import in_rgb as in_rgb
from .ground.registry import load_room as load_room
from .ground.types import FEATURE_NAMES as FEATURE_NAMES
from .ground.types import PHASES as PHASES
from .laws.base import works_on as works_on
from .laws.written import WrittenLaw as WrittenLaw
from .runs.judge import fit_decay as fit_decay
from .runs.judge import goal_pose as goal_pose
from .runs.judge import pose_error as pose_error
from .runs.judge import tracking as tracking
from .runs.judge import true_error as true_error
from .runs.loop import CLOSING_S as CLOSING_S
from .runs.loop import DEFAULT_LIMIT_S as DEFAULT_LIMIT_S
from .runs.measures import MEASURES as MEASURES
from .runs.measures import Track as Track
from .runs.measures import measures as measures
from .runs.measures import track_of as track_of
from .runs.pairing import StampPairer as StampPairer
from .runs.record import RecordBuilder as RecordBuilder
from .runs.record import STOP_NAMES as STOP_NAMES
from .runs.record import TWIST_NAMES as TWIST_NAMES
from .runs.sequence import ExperimentSequence as ExperimentSequence
from .runs.session import Session as Session
from .runs.settings import ExperimentSettings as ExperimentSettings
from .runs.settings import place_of as place_of
from .scenario.feasibility import Feasibility as Feasibility
from .scenario.reach_map import ReachMap as ReachMap
from .scenario.reach_map import reach_map as reach_map
from .scenario.schema import RobotSettings as RobotSettings
from .scenario.schema import default_of as default_of
from .scenario.schema import scenario_schema as scenario_schema
from .scenario.sweep import BALL_AXES as BALL_AXES
from .scenario.sweep import CAMERA_AXES as CAMERA_AXES
from .scenario.sweep import GOAL_AXES as GOAL_AXES
from .scenario.sweep import JOINT_HALF_WIDTH as JOINT_HALF_WIDTH
from .scenario.sweep import Perturbations as Perturbations
from .scenario.sweep import SweepSection as SweepSection
from .servo.stop_rule import StopSettings as StopSettings
from .studies import sister as sister
from .studies import study as study
