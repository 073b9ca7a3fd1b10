//! Benchmarks of sweetspot. Each program measures one subject: `cargo bench --bench inverse`, for example.
