"""Former names of modules: their paths answer for one release more, with a remark that says the new one."""

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
        "arrays citations errors integration>generalized_alpha labelled>datasets ties>ranking units version "
        "words>quantities",
    ),
    (
        "bases",
        "mechanics.shapes",
        "catalogue>registry eigen>beam_functions hermite>piecewise load_shapes>registry polynomials>piecewise "
        "segments>piecewise",
    ),
    (
        "cli",
        "app.cli",
        "commands_budget>commands_poses examples>commands_study key_names>commands_study map_options>pose_options",
    ),
    (
        "control",
        "control",
        "adaptive>gain_scheduling channels>state_space closing>feedback files>datasets "
        "frequency>frequency_response function>controllers histories>discretization impedances>feedback "
        "integrators>frequency_response interconnect>feedback laws>filters limits>loop_stability loops>loop_gain "
        "measured>measurements poles>frequency_response reduction>norms ring_down>measurements "
        "sampling>discretization scheduled>gain_scheduling spectra>random_response",
    ),
    ("control", "common", "arguments"),
    (
        "description",
        "analysis.description",
        "actuator>actuator_description bodies>clearance hydraulic>hydraulic_description leg>leg_description "
        "limits>drive_limits rest>residual_vibration robot>robot_description screw>screw_description",
    ),
    (
        "design",
        "design.first_robot",
        "catalogue choice>electric_choice design electric hydraulic sizes>sizing warm written>study_text",
    ),
    ("document", "output.text", "first>answers maps>answers modes>answers refusal>parts run>answers"),
    ("elements", "mechanics.leg", "carriage>joints cylinder>joints platform_joint>joints universal>joints"),
    (
        "elements",
        "mechanics.elements",
        "frame>frames known>registry rotations>frames shear>distribution summed_error>motor_loop",
    ),
    ("error_budget", "analysis.error_budget", "counted>text dataset>budget_dataset motion>along_motion sentences>text"),
    (
        "exchange",
        "output.exchange",
        "content>formats decks_beam>decks drawn>animation export>pose_deck glb>gltf state_space>formats uff>formats",
    ),
    (
        "feedforward",
        "commissioning.feedforward",
        "beam>actuator_inversion compensate>compensation corrections>correction_series drive_loads>loaded_path "
        "elastic>stable_inversion elastic_path>stable_inversion inversion>actuator_inversion loaded>loaded_path "
        "series>correction_series switching>bang_bang table>command_table vibration>modal_path way>straight_line",
    ),
    ("fem", "solve.fem", "leg_shapes>reduction mesh>hexahedra mouth>sliding"),
    (
        "kinematics",
        "kinematics",
        "breaks>discontinuities built>as_built ends>frames limbs>leg_geometry schedule>laws vectors>rotations",
    ),
    (
        "mechanics",
        "mechanics.leg",
        "assembly>kernel_functions closure>payload guide_layout>leg_beam layout leg_beam leg_chain payload "
        "sliding>kernel_functions",
    ),
    (
        "model",
        "model.leg",
        "actuator chain circle cylinder damping drive friction geometry guide hydraulic joint joint_stiffness "
        "material motor piston rolling screw sections spring",
    ),
    ("model", "model.study", "control disturbance home mount payload remarks robot robot_checks simulation tolerances"),
    ("model", "model.file", "fields files json_schema key_paths page plausible"),
    (
        "page",
        "app.browser",
        "door>access inputs>session knob>number_slider logs>background opening>header player>time_panel "
        "quick>preview scripts>markup typed>text_fields visitor>client_limits",
    ),
    (
        "paper",
        "verification.paper",
        "claims_welded>claims_variants cost>computing_time light>variants printed>printed_figures "
        "printed_lines>printed_equations readings>variants solid_figure>figures variant_figures>engine_figures "
        "welded>clamped_legs welded_figure>clamped_legs",
    ),
    ("plot", "output.figures", "narrow>column_width png>style settings>style vibration>linear"),
    (
        "pose_errors",
        "analysis.pose_errors",
        "at_home>home_accuracy at_pose>error_sources imperfect>bent_legs motion>backlash play>backlash "
        "pose>pose_accuracy rows>error_sources spread>tolerances weight>tolerances",
    ),
    ("report", "output.report", "curves>replay interactive>plotly_export linear>report page>report"),
    (
        "results",
        "analysis.results",
        "asked>lazy_arrays cause_words>cause_labels forces>leg_results ideal>idealizations inside>elongations "
        "names>variables of_elements>element_outputs path>rigid_path record>time_history robot>robot_results "
        "vibration>mode_shapes",
    ),
    ("results", "analysis", "netcdf>store"),
    (
        "review",
        "analysis.checks",
        "columns>estimates fixed_steps>stability reach>reachability room>resource_limits sliding>screws "
        "unstable_loops>stability",
    ),
    ("runtime", "common", "loading>lazy_imports memory>resources threads>resources"),
    ("scene", "output.scene", "colours>style drives>style robot>robot_scene"),
    ("schema", "common.tables", "notes>field_help written>toml"),
    ("solve.linear", "solve.linear", "beside>plant floor>plant gravity>plant grid>states robot>random_vibration"),
    ("solve.modal", "solve.modal", "damped>eigenproblem frequencies>eigenproblem loss_factor>structural_damping"),
    ("solve", "solve", "saddle>saddle_point"),
    (
        "solve.statics",
        "solve.statics",
        "arrow>block_arrow branch>assembly_mode drive_forces>static_loads locked>locked_robot "
        "released>ideal_robot shared>minimum_energy_forces substitutes>ideal_robot",
    ),
    (
        "solve.time",
        "solve.time",
        "redundant>overconstrained sampled>sampled_control stops>time_events tables>command_tables",
    ),
    ("solve.time", "common", "pieces>piecewise_chebyshev"),
    (
        "study",
        "analysis",
        "controlled>controller_settings many_modes>modes_at_poses parts>elastic_parts predicted>predicted_damping",
    ),
    ("surveys.sweeps", "design.sweeps", "batch>worker kept>outputs points>samples schedule>executors writer>worker"),
    ("surveys.sweeps", "analysis", "scalars"),
    ("surveys.workspace", "analysis", "quantities>pose_values"),
    ("symbolic", "mechanics.symbolic", "lagrange>functions"),
    (
        "verify.cases",
        "verification.cases",
        "calculix_corrections>calculix_beams calculix_robots>calculix_beams exports>linear",
    ),
    ("verify.engines", "verification.engines", "exudyn_friction>exudyn_builder mujoco_model>mujoco_forces"),
    ("verify", "verification", "locked_robot>dynamic_stiffness page>pack"),
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
