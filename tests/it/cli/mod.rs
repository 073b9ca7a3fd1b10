//! Tests the command in the way that scripts and people use it: exit codes, streams, files, and the JSON
//! contract.
//!
//! Every test runs the real binary in a separate folder.

mod allocate;
mod cache;
mod calibrate;
mod contract;
mod correct;
mod damage;
mod errors;
mod export;
mod figures;
mod foreign_files;
mod front;
mod init;
mod islands;
mod jobs;
mod lock;
mod manual;
mod measured_comparison;
mod measured_files;
mod measuring_plan;
mod numbers;
mod overrides;
mod own_robot;
mod postures;
mod print_out;
mod readings;
mod report;
mod robots;
mod robust;
mod ros;
pub mod sandbox;
mod schema;
mod shared_sweep;
#[cfg(unix)]
mod slurm;
mod stated_calibrations;
mod sweep;
mod urdf;
mod view;
mod view_server;
mod viewer;
mod worker;
mod yields;
