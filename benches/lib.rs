//! Benchmarks of sweetspot, one program per layer: `cargo bench --bench layers`.
