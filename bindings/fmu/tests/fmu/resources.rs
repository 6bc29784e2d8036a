//! Resources that make no instance.

use std::ffi::c_int;
use std::fs;

use crate::master::{MODEL_WITH_HISTORY, Unpacked, start, uri};

const CO_SIMULATION: c_int = 1;

#[track_caller]
fn refused(result: Result<crate::master::Master, String>, parts: &[&str]) {
    let said = result.err().expect("it was instantiated");
    for part in parts {
        assert!(said.contains(part), "{part:?} not in {said:?}");
    }
}

#[test]
fn another_guid_kind_or_folder_is_refused() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let (guid, uri) = (unpacked.contents.guid.clone(), unpacked.uri());
    let (guid, uri) = (guid.as_str(), uri.as_str());
    assert!(unpacked.try_instance(guid, uri).is_ok());
    let other = Unpacked::new(MODEL_WITH_HISTORY, 2e4);
    assert_ne!(other.contents.guid, guid);
    refused(
        unpacked.try_instance(&other.contents.guid, uri),
        &["fmuGUID = ", guid, "modelDescription.xml"],
    );
    refused(unpacked.try_instance("100% #", uri), &["fmuGUID = 100% #"]);
    refused(
        start(Some(guid), Some(uri), 0),
        &["fmuType = 0", "co-simulation"],
    );
    refused(start(None, Some(uri), CO_SIMULATION), &["fmuGUID = NULL"]);
    refused(
        start(Some(guid), None, CO_SIMULATION),
        &["fmuResourceLocation = NULL"],
    );
    refused(
        unpacked.try_instance(guid, "http://host/resources"),
        &["fmuResourceLocation", "no file: URI"],
    );
    refused(
        unpacked.try_instance(guid, "file:///no/such/folder"),
        &["/no/such/folder/model.json", "unpack the whole FMU"],
    );
}

#[test]
fn damaged_resources_are_refused() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let guid = unpacked.contents.guid.clone();
    let folder = unpacked.folder.path();
    let with = |file: &str, text: &str, parts: &[&str]| {
        let path = folder.join(file);
        let before = fs::read(&path).unwrap();
        fs::write(&path, text).unwrap();
        refused(unpacked.try_instance(&guid, &uri(folder)), parts);
        fs::write(&path, before).unwrap();
    };
    let model = fs::read_to_string(folder.join("model.json")).unwrap();
    let settings = fs::read_to_string(folder.join("fmu.json")).unwrap();
    with(
        "model.json",
        "",
        &["model.json", "not JSON", "export the model again"],
    );
    with("model.json", &model.replace("8.0", "1e300"), &["law", "k1"]);
    with("model.json", &model.replace("180.0", "181.0"), &["fmuGUID"]);
    with("fmu.json", "{}", &["fmu.json", "missing field"]);
    with(
        "fmu.json",
        &settings.replace("10000.0", "0.0"),
        &["tick_rate = 0"],
    );
    with(
        "fmu.json",
        &settings.replace("10000.0", "1e9"),
        &["tick_rate"],
    );
    with(
        "fmu.json",
        &settings.replace("10000.0", "5000.0"),
        &["fmuGUID"],
    );
    // A resource longer than the limit.
    with("fmu.json", &" ".repeat((16 << 20) + 1), &["longer than"]);
    assert!(unpacked.try_instance(&guid, &uri(folder)).is_ok());
}
