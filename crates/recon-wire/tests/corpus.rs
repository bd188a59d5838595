//! The corpus of the fuzz targets, and random inputs, through the same checks.
mod common;

#[path = "../../../fuzz/checks.rs"]
mod checks;

use common::{frame, nasty_bytes, packet};
use proptest::prelude::*;
use std::path::Path;

fn run_corpus(target: &str, check: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fuzz/corpus")
        .join(target);
    let mut inputs = 0;
    for entry in std::fs::read_dir(folder).expect("the corpus") {
        check(&std::fs::read(entry.expect("readable").path()).expect("readable"));
        inputs += 1;
    }
    assert!(inputs >= 20, "{target} has {inputs} inputs");
}

#[test]
fn the_corpus_of_packet_holds() {
    run_corpus("packet", checks::packet);
}

#[test]
fn the_corpus_of_deframer_holds() {
    run_corpus("deframer", checks::deframer);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_deframer_finds_what_the_oracle_finds(
        pieces in prop::collection::vec((packet(), nasty_bytes(60), any::<prop::sample::Index>(), 0u8..4), 0..5),
        reads in prop::collection::vec(any::<u8>(), 0..30),
    ) {
        let mut input = vec![reads.len() as u8];
        input.extend(&reads);
        for (packet, noise, place, damage) in pieces {
            let mut bytes = frame(&packet);
            let place = place.index(bytes.len());
            match damage {
                0 => bytes.truncate(place),
                1 => bytes[place] ^= 0x10,
                2 => drop(bytes.splice(place..place, noise.iter().copied())),
                _ => {}
            }
            input.extend(bytes);
        }
        checks::deframer(&input);
    }
}
