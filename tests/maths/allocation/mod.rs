//! Tests of tolerance allocation: reference values, an independent interior-point method, full enumeration.

mod independent;
mod grades;
mod reference;
