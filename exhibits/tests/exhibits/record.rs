//! Accepted records.

use std::io::{Error, ErrorKind};

use exhibits::record::Kept;

const FILE: &str = "name = \"speed\"\n\n[values.fast]\ntext = \"2\"\nvalue = 2.5\n";

fn sentence(kept: &Kept, value: &str) -> String {
    kept.value(value).unwrap_err()
}

#[test]
fn a_value_is_read_wherever_it_stands_in_its_table() {
    assert_eq!(Kept::of("speed", Ok(FILE.to_owned())).value("fast"), Ok(2.5));
}

#[test]
fn what_is_missing_is_named_with_the_command_that_makes_it() {
    let absent = Kept::of("speed", Err(Error::from(ErrorKind::NotFound)));
    assert_eq!(
        sentence(&absent, "fast"),
        "the record `speed` was never accepted; run `cargo book record speed`, then `cargo book accept`"
    );
    let without = sentence(&Kept::of("speed", Ok(FILE.to_owned())), "slow");
    assert!(without.contains("`speed` has no value `slow`; run `cargo book record speed`"));
    let damaged = sentence(&Kept::of("speed", Ok("values = 3".to_owned())), "fast");
    assert!(damaged.starts_with("exhibits/records/speed.toml is damaged"), "{damaged}");
    assert!(damaged.contains("run `cargo book record speed`"), "{damaged}");
}
