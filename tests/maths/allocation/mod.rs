//! Tests of tolerance allocation: reference values, an independent interior-point method, full enumeration.

mod figures;
mod grades;
mod independent;
mod reference;
