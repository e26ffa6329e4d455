//! Benchmarks of the distance solvers: `make bench` runs `solvers.rs`.
