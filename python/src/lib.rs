//! The Python face of the core: one file of glue per module of the crate.
