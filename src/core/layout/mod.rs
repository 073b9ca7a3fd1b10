//! Evaluation of one candidate layout. Search, what-if questions and reports all call [`evaluate`].

mod certify;
mod cycle;
mod ending;
mod evaluation;
mod goals;
mod held_judgement;
mod held_layout;
mod maps;
mod measurable;
mod misplacement;
mod objective;
mod refine;
mod robustness;
mod separate;
mod spot_choice;
mod workcell;

pub use certify::{LayoutCertificate, OperationCertificate};
pub use ending::Ending;
pub use evaluation::{Evaluation, Workspace, evaluate, evaluate_in};
pub use goals::MAX_CLEARANCE;
pub use held_layout::{HeldLayout, HeldMemory, Uncarried};
pub use measurable::{MeasurablePoses, Sightline};
pub use misplacement::Moves;
pub use objective::combined;
pub use refine::Refined;
pub use robustness::{Corner, Largest, Lost, MisplacementEnd, Robustness};
pub use separate::separated;
pub use workcell::Workcell;
