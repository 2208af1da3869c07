//! Scene files: strict TOML, overrides, randomisation, program and arm loading.
