//! Logs and pages.

use super::*;

const TREE: &str = "<Sequence><L name=\"a\" s=\"S\"/><L name=\"b\" s=\"RF\"/></Sequence>";

#[test]
fn a_log_has_the_layout_that_groot_reads() {
    let instance = instance(&file(TREE));
    let log = instance.btlog(&dry_run(&instance, 2, &[]).transitions);
    let rest = log.strip_prefix(b"BTCPP4-FileLogger2\x01").expect("magic and protocol");
    let (length, rest) = rest.split_at(4);
    let length = i32::from_le_bytes(length.try_into().unwrap()) as usize;
    let (xml, rest) = rest.split_at(length);
    let xml = std::str::from_utf8(xml).unwrap();
    assert!(xml.contains("<Sequence name=\"Sequence\" _uid=\"1\">") && xml.contains("_uid=\"3\""), "{xml}");
    assert!(Document::parse("log", xml, &Extras::default()).is_ok());
    let (start, records) = rest.split_at(8);
    assert_eq!(start, [0; 8]);
    let record = |record: &[u8]| {
        let time = u64::from_le_bytes([&record[..6], &[0, 0]].concat().try_into().unwrap());
        (time, u16::from_le_bytes([record[6], record[7]]), record[8])
    };
    assert_eq!(records.len() % 9, 0);
    let records: Vec<_> = records.chunks(9).map(record).collect();
    // a succeeds, b and the root run; 10 ms later a is idle again, b and the root fail.
    let expected = [(0, 2, 2), (0, 3, 1), (0, 1, 1), (10_000, 2, 0), (10_000, 3, 3), (10_000, 1, 3)];
    assert_eq!(records, expected);
}

#[test]
fn a_page_shows_every_node_and_how_it_ended() {
    let instance = instance(&file(TREE));
    let page = instance.timeline(&dry_run(&instance, 2, &[]).transitions);
    assert!(page.contains(">a</text>") && page.contains(">b</text>"));
    assert_eq!(page.matches("class=\"running\"").count(), 2);
    assert!(page.contains("FAILURE at 10 ms") && page.contains("SUCCESS at 0 ms"));
    assert!(!page.contains("src=") && !page.contains("href="), "the page is complete in itself");
}
