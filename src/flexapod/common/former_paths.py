"""What modules were called before: their paths answer for one release more, with a remark that says the new one."""

#: Packages, and where they are now.
PACKAGES = {
    "bases": "mechanics.shapes",
    "cli": "app.cli",
    "description": "analysis.description",
    "document": "output.text",
    "elements": "mechanics.elements",
    "error_budget": "analysis.error_budget",
    "exchange": "output.exchange",
    "feedforward": "commissioning.feedforward",
    "fem": "solve.fem",
    "page": "app.browser",
    "paper": "verification.paper",
    "plot": "output.figures",
    "pose_errors": "analysis.pose_errors",
    "report": "output.report",
    "results": "analysis.results",
    "review": "analysis.checks",
    "runtime": "common",
    "scene": "output.scene",
    "schema": "common.tables",
    "study": "analysis",
    "surveys": "design",
    "surveys.convergence": "design.convergence",
    "surveys.sweeps": "design.sweeps",
    "surveys.workspace": "design.maps",
    "symbolic": "mechanics.symbolic",
    "verify": "verification",
    "verify.cases": "verification.cases",
    "verify.engines": "verification.engines",
}
#: Modules that have another name or place than their package says: folder before, folder now, and names.
MODULES = (
    (
        "",
        "common",
        "arrays citations errors units version integration>generalized_alpha labelled>datasets ties>ranking "
        "words>quantities",
    ),
    ("bases", "mechanics.shapes", "catalogue>registry hermite>piecewise"),
    ("control", "common", "arguments"),
    (
        "control",
        "control",
        "frequency>frequency_response interconnect>feedback laws>filters limits>loop_stability "
        "measured>measurements sampling>discretization scheduled>gain_scheduling spectra>random_response",
    ),
    (
        "description",
        "analysis.description",
        "actuator>actuator_description bodies>clearance hydraulic>hydraulic_description leg>leg_description "
        "limits>drive_limits rest>residual_vibration robot>robot_description screw>screw_description",
    ),
    ("design", "design.first_robot", "choice>electric_choice sizes>sizing written>study_text"),
    ("document", "output.text", "run>answers"),
    ("elements", "mechanics.leg", "cylinder platform_joint universal carriage>joints"),
    ("elements", "mechanics.elements", "frame>frames known>registry"),
    ("error_budget", "analysis.error_budget", "dataset>budget_dataset motion>along_motion sentences>text"),
    (
        "feedforward",
        "commissioning.feedforward",
        "beam>actuator_inversion corrections>correction_series elastic>stable_inversion "
        "inversion>noncausal_filter loaded>loaded_path switching>bang_bang table>command_table "
        "vibration>modal_path way>straight_line",
    ),
    ("kinematics", "kinematics", "breaks>discontinuities built>as_built limbs>leg_geometry"),
    ("mechanics", "mechanics.leg", "assembly>kernel_functions"),
    (
        "model",
        "model.leg",
        "actuator chain circle cylinder damping drive friction geometry guide hydraulic joint joint_stiffness "
        "material motor piston rolling screw sections spring",
    ),
    ("model", "model.study", "control disturbance home mount payload remarks robot robot_checks simulation tolerances"),
    ("model", "model.file", "fields files json_schema key_paths page plausible"),
    ("page", "app.browser", "door>access knob>number_slider quick>preview typed>text_fields visitor>client_limits"),
    (
        "paper",
        "verification.paper",
        "cost>computing_time light>light_pistons printed>printed_figures printed_lines>printed_equations "
        "welded>clamped_legs",
    ),
    ("plot", "output.figures", "narrow>column_width panel>fast_axes twice>dual_renderer"),
    (
        "pose_errors",
        "analysis.pose_errors",
        "at_home>accuracy_text at_pose>error_sources imperfect>bent_legs play>backlash pose>pose_accuracy "
        "spread>tolerances",
    ),
    ("report", "output.report", "interactive>plotly_export page>report"),
    (
        "results",
        "analysis.results",
        "asked>lazy_arrays cause_words>cause_labels ideal>idealizations names>variables "
        "of_elements>element_outputs path>rigid_path record>time_history robot>robot_results",
    ),
    ("results", "analysis", "netcdf"),
    ("review", "analysis.checks", "reach>reachability room>resource_limits unstable_loops>stability"),
    ("runtime", "common", "loading>lazy_imports threads>resources"),
    ("scene", "output.scene", "drives>style robot>robot_scene"),
    ("schema", "common.tables", "notes>field_help written>source_text"),
    ("solve.modal", "solve.modal", "frequencies>eigenproblem loss_factor>structural_damping"),
    ("solve", "solve", "saddle>saddle_point"),
    (
        "solve.statics",
        "solve.statics",
        "arrow>block_arrow branch>assembly_mode locked>locked_robot released>ideal_robot shared>minimum_energy_forces",
    ),
    (
        "solve.time",
        "solve.time",
        "pieces>piecewise_chebyshev redundant>overconstrained sampled>sampled_control stops>time_events "
        "tables>command_tables",
    ),
    (
        "study",
        "analysis",
        "controlled>controller_settings many_modes>modes_at_poses parts>elastic_parts predicted>predicted_damping",
    ),
    ("surveys.sweeps", "design.sweeps", "batch>worker kept>outputs points>samples"),
    ("surveys.sweeps", "analysis", "scalars"),
    ("surveys.workspace", "analysis", "quantities>pose_values"),
)


def new_path(old: str) -> str | None:
    """Path of a module of the package by the one that it had before; None where it had no other."""
    parts = old.split(".")[1:]
    for n in range(len(parts), 0, -1):
        if (head := ".".join(parts[:n])) in _PATHS:
            return ".".join(["flexapod", _PATHS[head], *parts[n:]])
    return None


_PATHS = PACKAGES | {
    ".".join(filter(None, (before, name.split(">")[0]))): f"{now}.{name.split('>')[-1]}"
    for before, now, names in MODULES
    for name in names.split()
}
