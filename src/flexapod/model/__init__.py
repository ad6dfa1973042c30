"""WHAT is analysed: frozen descriptions in SI units, read from text files with units."""

from flexapod.model.actuator import Actuator, ActuatorInitial, ActuatorLoad, ActuatorMotion
from flexapod.model.chain import Chain, chain_of, chains_of
from flexapod.model.circle import base_circle, platform_circle
from flexapod.model.control import Control, DampedControl, FileControl, ForceControl, StrokeControl, ToolControl
from flexapod.model.cylinder import Cylinder, Mounted
from flexapod.model.damping import Damping, damping_parts
from flexapod.model.disturbance import CURVES, Disturbance, Floor, Spectrum
from flexapod.model.drive import Feedback, ForceDrive, PrescribedDrive, ServoDrive
from flexapod.model.files import (
    PAPER_PRESETS,
    PRESETS,
    OpenValue,
    load,
    loads,
    loads_robot,
    open_values,
    preset,
    preset_text,
)
from flexapod.model.friction import JointFriction, ScrewFriction, StrokeFriction
from flexapod.model.geometry import Geometry
from flexapod.model.guide import Guide
from flexapod.model.heat import Expansion, Gradient, Heat
from flexapod.model.home import Home
from flexapod.model.hydraulic import HydraulicDrive, HydraulicLimits
from flexapod.model.joint import Carriage, Joint, Travel
from flexapod.model.laws import (
    ConstantLaw,
    ConstantWrench,
    CsvLaw,
    CsvWrench,
    Load,
    LoadLaw,
    MotionLaw,
    ProfileLaw,
    RateLaw,
    SineLaw,
    SineWrench,
    SpinUpLaw,
    StepLaw,
    StepWrench,
    Wrench,
)
from flexapod.model.leg import Leg, Stroke
from flexapod.model.material import MATERIALS, Material, Rectangle, Tube
from flexapod.model.motion import (
    AXES,
    PROFILES,
    AxisMotion,
    CombinedMotion,
    CsvMotion,
    Motion,
    Waypoint,
    WaypointMotion,
)
from flexapod.model.payload import Payload
from flexapod.model.piston import Piston, Strut
from flexapod.model.robot import Robot
from flexapod.model.rolling import RollingLaw
from flexapod.model.screw import Bearing, Brake, Drive, Encoder, Limits, Loop, Motor, Nut, Ripple, Rotor, ScrewDrive
from flexapod.model.sections import PistonSection
from flexapod.model.simulation import DEFAULT_TOLERANCE, FIDELITIES, Initial, Simulation
from flexapod.model.spring import AxialSpring
from flexapod.model.study import DRIVEN_BY, ActuatorStudy, Study, override, to_toml
from flexapod.model.tolerances import LengthSpread, RatioSpread, Spread, Tolerances

__all__ = [
    "AXES",
    "CURVES",
    "DEFAULT_TOLERANCE",
    "DRIVEN_BY",
    "FIDELITIES",
    "MATERIALS",
    "PAPER_PRESETS",
    "PRESETS",
    "PROFILES",
    "Actuator",
    "ActuatorInitial",
    "ActuatorLoad",
    "ActuatorMotion",
    "ActuatorStudy",
    "AxialSpring",
    "AxisMotion",
    "Bearing",
    "Brake",
    "Carriage",
    "Chain",
    "CombinedMotion",
    "ConstantLaw",
    "ConstantWrench",
    "Control",
    "CsvLaw",
    "CsvMotion",
    "CsvWrench",
    "Cylinder",
    "DampedControl",
    "Damping",
    "Disturbance",
    "Drive",
    "Encoder",
    "Expansion",
    "Feedback",
    "FileControl",
    "Floor",
    "ForceControl",
    "ForceDrive",
    "Geometry",
    "Gradient",
    "Guide",
    "Heat",
    "Home",
    "HydraulicDrive",
    "HydraulicLimits",
    "Initial",
    "Joint",
    "JointFriction",
    "Leg",
    "LengthSpread",
    "Limits",
    "Load",
    "LoadLaw",
    "Loop",
    "Material",
    "Motion",
    "MotionLaw",
    "Motor",
    "Mounted",
    "Nut",
    "OpenValue",
    "Payload",
    "Piston",
    "PistonSection",
    "PrescribedDrive",
    "ProfileLaw",
    "RateLaw",
    "RatioSpread",
    "Rectangle",
    "Ripple",
    "Robot",
    "RollingLaw",
    "Rotor",
    "ScrewDrive",
    "ScrewFriction",
    "ServoDrive",
    "Simulation",
    "SineLaw",
    "SineWrench",
    "Spectrum",
    "SpinUpLaw",
    "Spread",
    "StepLaw",
    "StepWrench",
    "Stroke",
    "StrokeControl",
    "StrokeFriction",
    "Strut",
    "Study",
    "Tolerances",
    "ToolControl",
    "Travel",
    "Tube",
    "Waypoint",
    "WaypointMotion",
    "Wrench",
    "base_circle",
    "chain_of",
    "chains_of",
    "damping_parts",
    "load",
    "loads",
    "loads_robot",
    "open_values",
    "override",
    "platform_circle",
    "preset",
    "preset_text",
    "to_toml",
]
