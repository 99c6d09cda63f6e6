//! Users' characters of any content: an error, or a character that can play somebody, never a panic.
#![no_main]

#[path = "../../tests/fixture/mod.rs"]
mod fixture;

use std::sync::LazyLock;

use crowdquilt::export::{Avatar, glb_with};
use crowdquilt::stage::Crowd;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

static CROWD: LazyLock<Crowd> = LazyLock::new(|| fixture::lattice(1, 2));

fuzz_target!(|bytes: &[u8]| {
    let Ok(avatar) = Avatar::open(bytes) else { return };
    assert!(glb_with(&CROWD, &[avatar]).starts_with(b"glTF"));
});
