//! From recordings to the effect that the law lacks.

pub mod result;
