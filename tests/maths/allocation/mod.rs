//! Tests of tolerance allocation: reference values, an independent interior-point method, full enumeration.

mod dual;
mod figures;
mod grades;
mod independent;
mod reference;
mod search;
