//! The `lixel` command.
fn main() {}
