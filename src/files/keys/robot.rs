//! Keys of robots and tools.

use super::constraints::POSTURE;
use super::errors::error_set;
use super::key::*;
use super::parts::*;
use super::solid::{link_solid, rectangle, solid};
use crate::cell::{Convention, MAX_JOINTS};

/// Kind of motion of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointMotion {
    Revolute,
    Prismatic,
    /// Revolute joint without an actuator: the joint coupling rotates it when other joints move.
    Passive,
}

impl JointMotion {
    pub const ALL: [Self; 3] = [Self::Revolute, Self::Prismatic, Self::Passive];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Passive => "passive",
        }
    }
}

words!(JointMotion);

const MAX_VELOCITY_DEG: Key =
    number("max_velocity_deg_s", NumberRange::Positive, "Maximum speed of a revolute joint.").example("180");
const MAX_VELOCITY_MM: Key =
    number("max_velocity_mm_s", NumberRange::Positive, "Maximum speed of a prismatic joint.").example("500");
const MAX_ACCELERATION_DEG: Key = number(
    "max_acceleration_deg_s2",
    NumberRange::Positive,
    "Maximum acceleration and deceleration of a revolute joint; if left out, it follows from full_speed_after_s.",
)
.example("600");
const MAX_ACCELERATION_MM: Key = number(
    "max_acceleration_mm_s2",
    NumberRange::Positive,
    "Maximum acceleration and deceleration of a prismatic joint; if left out, it follows from full_speed_after_s.",
)
.example("2000");

const LIMITS: ValueKind = ValueKind::List(&FINITE, (2, 2), "numbers");

const SOLIDS_OF_LINKS: ValueKind =
    ValueKind::List(&ValueKind::Table(&link_solid::TABLE), (0, UNBOUNDED), "solids");

/// Solids of a tool or a held part, which belong to no link.
const SOLIDS: ValueKind = ValueKind::List(&ValueKind::Table(&solid::TABLE), (0, UNBOUNDED), "solids");

key_table! {
    joint, "a joint", "D-H row of one joint. A standard row of a revolute joint is A = Rz(q_offset + q) Tz(r) Tx(l) Rx(alpha).", {
        NAME = Key::new("name", ValueKind::Name, "Name of the joint for messages.").required();
        R = number("r_mm", NumberRange::Finite, "Axial offset r along z; a prismatic joint adds its coordinate to r.").required();
        L = number("l_mm", NumberRange::Finite, "Common normal l along x.").required();
        ALPHA = number("alpha_deg", NumberRange::Finite, "Twist alpha about x.").required();
        MOTION = word::<JointMotion>("kind", "Kind of joint; a passive joint has no actuator and rotates with other joints through the coupling.").default(Literal::Word(JointMotion::Revolute.name()));
        Q_OFFSET = number("q_offset_deg", NumberRange::Finite, "Angle theta of a revolute joint at coordinate 0.");
        THETA = number("theta_deg", NumberRange::Finite, "Angle theta of a prismatic joint.");
        LIMITS_DEG = Key::new("limits_deg", LIMITS, "Lower and upper limit of a revolute joint.").example("[-90, 90]");
        LIMITS_MM = Key::new("limits_mm", LIMITS, "Lower and upper limit of a prismatic joint.").example("[-90, 90]");
        MAX_VELOCITY_DEG = super::MAX_VELOCITY_DEG;
        MAX_VELOCITY_MM = super::MAX_VELOCITY_MM;
        MAX_ACCELERATION_DEG = super::MAX_ACCELERATION_DEG;
        MAX_ACCELERATION_MM = super::MAX_ACCELERATION_MM;
    }
    rules [
        Rule::When { key: "kind", words: || vec!["revolute".into()], needs: &["q_offset_deg", "limits_deg"], never: &["theta_deg", "limits_mm", "max_velocity_mm_s", "max_acceleration_mm_s2"] },
        Rule::When { key: "kind", words: || vec!["prismatic".into()], needs: &["theta_deg", "limits_mm"], never: &["q_offset_deg", "limits_deg", "max_velocity_deg_s", "max_acceleration_deg_s2"] },
        Rule::When { key: "kind", words: || vec!["passive".into()], needs: &["q_offset_deg"], never: &["theta_deg", "limits_deg", "limits_mm", "max_velocity_deg_s", "max_velocity_mm_s", "max_acceleration_deg_s2", "max_acceleration_mm_s2"] },
    ];
}

key_table! {
    joint_rate, "a rate", "Maximum speed and acceleration of one joint, for a robot whose joints come from a URDF or from another file.", {
        JOINT = Key::new("joint", ValueKind::Either(&[ValueKind::Whole(1, MAX_JOINTS as u64), ValueKind::Text]), "Joint, by its number (counted from 1) or by its name.").required().example("1").remedy("add joint = 1, the number or the name of the joint");
        MAX_VELOCITY_DEG = super::MAX_VELOCITY_DEG;
        MAX_VELOCITY_MM = super::MAX_VELOCITY_MM;
        MAX_ACCELERATION_DEG = super::MAX_ACCELERATION_DEG;
        MAX_ACCELERATION_MM = super::MAX_ACCELERATION_MM;
    }
}

const PAIRS: ValueKind =
    ValueKind::List(&ValueKind::List(&ValueKind::Text, (2, 2), "names"), (0, UNBOUNDED), "pairs");

/// Largest mass of a link, a tool or a part, kg.
const MAX_MASS: f64 = 10_000.0;

key_table! {
    mass, "a mass", "Mass of a link. The weight of the mass deflects joints that have a compliance.", {
        LINK = Key::new("link", ValueKind::Whole(1, MAX_JOINTS as u64), "Number k of the link that carries the mass. D-H row k ends at the frame of link k.").required().example("2").remedy("add link = 2, the number of the link");
        MASS = number("mass_kg", NumberRange::UpTo(MAX_MASS), "Mass.").required().example("12.5").remedy("add mass_kg = 12.5");
        CENTRE = vector_or_zero("centre_mm", "Centre of mass in the frame of the link.");
    }
}

const MASS_OF_TOOL: Key = number_or_zero(
    "mass_kg",
    NumberRange::UpTo(MAX_MASS),
    "Mass of the tool or part. The weight of the mass deflects joints that have a compliance.",
);

key_table! {
    self_collision, "`self_collision`", "Solids of the robot that may touch each other.", {
        ALLOWED = Key::new("allowed", PAIRS, "Pairs of solids that may touch each other, given by their names.").required().example("[[\"hand\", \"cable\"]]").remedy("add allowed = [[\"NAME\", \"NAME\"]], pairs of solids that may touch each other");
    }
}

key_table! {
    tool, "a tool", "Tool: its TCP, working direction and solids, in the frame of the mechanical interface (after the last row).", {
        FROM = from("\"equipment/gripper.toml\"");
        SCHEMA = schema("sweetspot/tool/1");
        UNITS = super::UNITS;
        NAME = text("name", "Name of the tool for readers of the file.");
        SOURCE = super::SOURCE;
        POSITION = vector("position_mm", "Position of the tool centre point (TCP).").required().example("[0, 0, 160]");
        RPY = super::RPY;
        AXIS = direction("axis", "Vector along the working direction of the tool, in the frame of the TCP. Any length except 0 is allowed.").required().remedy("add axis = [1, 0, 0], the working direction of the tool");
        SOLID = Key::new("solid", SOLIDS, "Solids of the tool, in the frame of the mechanical interface.");
        MASS = super::MASS_OF_TOOL;
        CENTRE = vector_or_zero("centre_mm", "Centre of mass of the tool, in the frame of the mechanical interface.");
    }
}

key_table! {
    held, "`held`", "Part that the robot holds at an operation. Collision checks include the part.", {
        SOLID = Key::new("solid", SOLIDS, "Solids of the part, in the frame of the TCP.").required_unless("mass_kg").remedy("add solid = [{ name = \"part\", box = { centre_mm = [0, 0, 0], size_mm = [50, 50, 50] } }]");
        MASS = super::MASS_OF_TOOL;
        CENTRE = vector_or_zero("centre_mm", "Centre of mass of the part, in the frame of the TCP.");
        TOUCHES = boolean("touches_surface", false, "Whether the part rests on the work surface of the operation. If true, the part is not checked for collision with the equipment of that surface.");
    }
}

key_table! {
    robot, "a robot", "Robot: D-H rows or a URDF, tool, solids, error sets.", {
        FROM = from("\"robots/hitachi_pw10.toml\"");
        SCHEMA = schema("sweetspot/robot/1");
        UNITS = super::UNITS;
        NAME = Key::new("name", ValueKind::Name, "Name of the robot.").required_unless("urdf");
        SOURCE = super::SOURCE.required_unless("urdf").example("").remedy("add source = \"...\"");
        CONVENTION = word::<Convention>("convention", "Order of the rows: Rz Tz Tx Rx (standard) or Tx Rx Rz Tz (modified, Craig).").default(Literal::Word(Convention::Standard.name()));
        JOINT = Key::new("joint", ValueKind::List(&ValueKind::Table(&joint::TABLE), (1, MAX_JOINTS), "D-H rows"), "D-H rows, starting at the base: one [[joint]] for each joint.").required_unless("urdf").remedy("add a [[joint]] for every D-H row, with its limits");
        COUPLING = Key::new("coupling", ValueKind::List(&POSTURE, (1, MAX_JOINTS), "rows"), "Coupling: row i lists the factor by which each actuator coordinate enters D-H coordinate i. Factor i of row i is 1, and all later factors are 0.").example("[[1, 0], [1, 1]]");
        HOME = Key::new("home", POSTURE, "Home posture: one number for each joint, in degrees or mm. If left out, each coordinate is 0, or the middle of the joint limits if 0 is outside the limits.").example("[0, -30, 60, 0]");
        RATE = Key::new("rate", ValueKind::List(&ValueKind::Table(&joint_rate::TABLE), (0, MAX_JOINTS), "rates"), "Maximum speeds and accelerations of joints; they override the values of the rows, or of the URDF.").example("[{ joint = 1, max_velocity_deg_s = 180, max_acceleration_deg_s2 = 600 }]");
        FULL_SPEED_AFTER = number("full_speed_after_s", NumberRange::Positive, "Time from rest to full speed for every joint without an acceleration limit; if left out, cycle times assume 0.5 s and are estimates.").example("0.3");
        URDF = text("urdf", "URDF file (without xacro) that replaces the D-H rows. The path is relative to the folder of this file.").example("\"robots/arm.urdf\"");
        BASE_LINK = text("base_link", "Link of the URDF that stands still; if left out, the root link.").example("\"base\"");
        TIP_LINK = text("tip_link", "Link of the URDF that carries the tool; if left out, the only link without children.").example("\"flange\"");
        PACKAGES = Key::new("packages", ValueKind::Named(&ValueKind::Text, 0), "Folders of the ROS packages that the URDF names. Each path is relative to the folder of this file.").example("{ NAME = \"FOLDER\" }");
        TOOL = table("tool", &tool::TABLE, "Tool at the mechanical interface.").required().remedy("add tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }");
        FOOTPRINT = table("footprint", &rectangle::TABLE, "Rectangle that the base occupies in plan. The occupied space extends from the floor up to the top of the solids of link 0. If left out, the rectangle covers these solids.").remedy("add footprint = { size_mm = [600, 600] }");
        SOLID = Key::new("solid", SOLIDS_OF_LINKS, "Solids on the links.");
        MASS = Key::new("mass", ValueKind::List(&ValueKind::Table(&mass::TABLE), (0, UNBOUNDED), "masses"), "Masses of the links, for errors with compliance_deg_per_Nm.").example("[{ link = 2, mass_kg = 12.5, centre_mm = [-200, 0, 0] }]");
        SELF_COLLISION = Key::new("self_collision", ValueKind::Either(&[ValueKind::Boolean, ValueKind::Table(&self_collision::TABLE)]), "Check of the robot for collision with itself: true, false or a table. A table turns the check on and lists the pairs of solids that are allowed to touch.").default(Literal::Boolean(true));
        ERRORS = Key::new("errors", ValueKind::Named(&ValueKind::Table(&error_set::TABLE), 1), "Error sets: one table [errors.NAME] for each set.").required().remedy("add [errors.NAME] with kind = \"signed\", dr_mm, dl_mm and dalpha_deg");
    }
    rules [
        Rule::Excludes("urdf", &["joint", "coupling", "convention"]),
        Rule::OnlyWith("urdf", &["base_link", "tip_link", "packages"]),
    ];
}

key_table! {
    /// Keys of the table `[robot]` of a cell.
    robot_in_cell, "`robot`", "Robot of a cell and the placement of its base.", {
        BASE = table("base", &placement::TABLE, "Placement of the robot base in the world; if left out, the origin.");
        BASE_TOLERANCE = table("base_tolerance", &placement_tolerance::TABLE, "Tolerance of the placement of the robot base: the layout must work everywhere within this tolerance. If left out, it is 2 mm and 0.2 degrees for a base that a search places.").example("{ x_mm = 0.5, yaw_deg = 0.05 }");
        PEDESTAL = Key::new("pedestal", ValueKind::Either(&[ValueKind::Boolean, ValueKind::Table(&rectangle::TABLE)]), "Pedestal of a robot base above the floor: true, false or a table. The pedestal is drawn and checked for collision. If true, the pedestal is as large as the footprint of the robot. A table gives the cross-section of the pedestal in the base frame. Write false for a base on a wall or a gantry.").default(Literal::Boolean(true));
    }
    extends super::robot::TABLE;
    rules [Rule::Needs("schema", "units")];
}
