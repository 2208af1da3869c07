use crate::*;

#[test]
fn lines_comments_blanks_and_capitals() {
    let config = PropertyConfig::parse(
        "# id, step, key\n\nread,5,3,xCount\n WRITE , 1 , 3 , xOffset , 10 # mm\nwrite,1,3,name,a, b\nRead,6,3,yCount",
    )
    .unwrap();
    let line = config.read(5).unwrap();
    assert_eq!((line.step, line.key.as_str()), (3, "xCount"));
    assert_eq!(config.read(6).unwrap().key, "yCount");
    assert_eq!(config.read(1), None);
    let values: Vec<_> = config.writes(1).unwrap().iter().map(|w| &w.value).collect();
    assert_eq!(
        values,
        [
            &PropertyValue::Number(10.0),
            &PropertyValue::Text("a, b".to_owned())
        ]
    );
    assert_eq!(config.writes(5), None);
}

#[track_caller]
fn check_refused(text: &str, expected: &str) {
    let error = PropertyConfig::parse(text).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!("property configuration, line {expected}")
    );
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    check_refused(
        "\nset,1,2,a",
        "2: expected `read` or `write`, found \"set\"",
    );
    check_refused("read,1,2", "1: expected 4 fields, found 3");
    check_refused("read,1,2,a,5", "1: expected 4 fields, found 5");
    check_refused("write,1,2,a", "1: expected 5 fields, found 4");
    check_refused("read,x,2,a", "1: id: expected a whole number, found \"x\"");
    check_refused(
        "read,1,2.5,a",
        "1: step: expected a whole number, found \"2.5\"",
    );
    check_refused("read,1,2,", "1: the key is empty");
    check_refused("read,1,2,a\nread,1,3,b", "2: read id 1 is there twice");
    let settings = ServerSettings {
        property_config: "read".to_owned(),
        ..ServerSettings::default()
    };
    assert!(matches!(
        Server::new(settings),
        Err(InterfaceError::PropertyConfig(_))
    ));
}
