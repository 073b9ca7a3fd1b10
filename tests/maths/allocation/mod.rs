//! Tests of tolerance allocation: reference values, an independent interior-point method, full enumeration.

mod grades;
mod independent;
mod reference;
