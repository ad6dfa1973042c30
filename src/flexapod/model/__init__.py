"""WHAT is analysed: frozen descriptions in SI units, read from text files with units."""

from flexapod.model.file.files import (
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
from flexapod.model.heat import Expansion, Gradient, Heat
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
from flexapod.model.leg.actuator import Actuator, ActuatorInitial, ActuatorLoad, ActuatorMotion
from flexapod.model.leg.chain import Chain, chain_of, chains_of
from flexapod.model.leg.circle import base_circle, platform_circle
from flexapod.model.leg.cylinder import Cylinder, Mounted
from flexapod.model.leg.damping import Damping, damping_parts
from flexapod.model.leg.drive import Feedback, ForceDrive, PrescribedDrive, ServoDrive
from flexapod.model.leg.friction import JointFriction, ScrewFriction, StrokeFriction
from flexapod.model.leg.geometry import Geometry
from flexapod.model.leg.guide import Guide
from flexapod.model.leg.hydraulic import HydraulicDrive, HydraulicLimits
from flexapod.model.leg.joint import Carriage, Joint, Travel
from flexapod.model.leg.leg import Leg, Stroke
from flexapod.model.leg.material import MATERIALS, Material, Rectangle, Tube
from flexapod.model.leg.motor import Ripple
from flexapod.model.leg.piston import Piston, Strut
from flexapod.model.leg.rolling import RollingLaw
from flexapod.model.leg.screw import Bearing, Brake, Drive, Encoder, Limits, Loop, Motor, Nut, Rotor, ScrewDrive
from flexapod.model.leg.sections import PistonSection
from flexapod.model.leg.spring import AxialSpring
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
from flexapod.model.study.control import Control, DampedControl, FileControl, ForceControl, StrokeControl, ToolControl
from flexapod.model.study.disturbance import CURVES, Disturbance, Floor, Spectrum
from flexapod.model.study.home import Home
from flexapod.model.study.payload import Payload
from flexapod.model.study.robot import Robot
from flexapod.model.study.simulation import DEFAULT_TOLERANCE, FIDELITIES, Initial, Simulation
from flexapod.model.study.study import DRIVEN_BY, ActuatorStudy, Study, override, to_toml
from flexapod.model.study.tolerances import LengthSpread, RatioSpread, Spread, Tolerances

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
